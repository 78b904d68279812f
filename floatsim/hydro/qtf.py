"""Quadratic transfer functions: second-order wave forces by pairs of waves.

Two waves a_m, a_n (complex, of e^{i w t}) of one heading give the second-order force

    difference   Re sum_m sum_n T(w_m, w_n) a_m conj(a_n) e^{i(w_m - w_n) t},   T(w_n, w_m) = conj T(w_m, w_n)
    sum          Re sum_m sum_n T(w_m, w_n) a_m a_n e^{i(w_m + w_n) t},         T(w_n, w_m) = T(w_m, w_n)

over all m and n, both orders and m = n included (Pinkster 1980; WAMIT User Manual v7, chapter on second order). A
regular wave has the mean drift |a|^2 T(w, w), which is real. T in N/m2 and N m/m2, phases relative to the origin
of the frame the hull was drawn in, as those of the excitation.

Between its frequencies T is linear, as a complex field, along mean and difference frequency: each cell of the grid
is cut along its line of constant difference, on which T varies slowly (the mean drift is the line of difference
zero and stays real), into two triangles. Outside the grid, or next to entries that were never computed, T is zero;
who uses it says how much of the sea that leaves out. Over the headings it is linear too, between headings at most
30 deg apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError
from floatsim.hydro.wamit import _once, _rows

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_SAME = math.radians(1.0)  # waves so close to a heading of the QTF are taken to run along it
_APART = math.radians(30.0) + 1e-6  # neighbouring headings so far apart are still interpolated
_UNEQUAL = 1e-3  # of the largest entry: how far the two halves may be from (conjugate) symmetry
_ROTATION = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])


@dataclass(frozen=True, eq=False, kw_only=True)
class QTF:
    """Quadratic transfer function of one floater about its reference point. Arrays are read-only.

    name             what messages call it
    kind             "difference" or "sum"
    omega            (p,) rad/s, increasing, positive
    headings         (h,) rad in [-pi, pi), increasing, relative to the drawn hull; both waves have the same
    transfer         (h, p, p, 6) complex, N/m2 and N m/m2, [., m, n] for w_m (counted positive) and w_n;
                     NaN where not computed. One half, m >= n or m <= n, will do.
    reference_point  (3,) m, of the moments, in the frame the hull was drawn in
    file             that the numbers were read from, or None

    Raises ModelError, all problems at once, for shapes that do not fit and halves that contradict each other.
    """

    name: str
    kind: Literal["difference", "sum"]
    omega: Array
    headings: Array
    transfer: Complex
    reference_point: Array
    file: str | Path | None = None

    def __post_init__(self) -> None:
        label = f"QTF '{self.name}'"
        omega, headings = np.array(self.omega, dtype=float), np.array(self.headings, dtype=float)
        T, point = np.array(self.transfer, dtype=complex), np.array(self.reference_point, dtype=float)
        problems = []
        if self.kind not in ("difference", "sum"):
            problems.append(f"{label}: kind is {self.kind!r}, must be 'difference' or 'sum'")
        if omega.ndim != 1 or omega.size < 2 or not (np.all(omega > 0.0) and np.all(np.diff(omega) > 0.0)):
            problems.append(f"{label}: omega must be at least two positive frequencies, increasing")
        if headings.ndim != 1 or headings.size < 1 or not (
            np.all(np.abs(headings) < np.pi + 1e-9) and np.all(np.diff(headings) > 0.0)
        ):  # fmt: skip
            problems.append(f"{label}: headings must be at least one, in [-pi, pi), increasing")
        wanted = (headings.size, omega.size, omega.size, 6)
        if T.shape != wanted:
            problems.append(
                f"{label}: transfer has shape {T.shape}, must be {wanted} ({headings.size} headings, {omega.size} "
                "by as many frequencies, 6 degrees of freedom)"
            )
        if point.shape != (3,) or not np.all(np.isfinite(point)):
            problems.append(f"{label}: reference_point must be three finite coordinates, m")
        if problems:
            raise ModelError(problems)
        T = _filled(T, self.kind, omega, label)
        for name, value in (("omega", omega), ("headings", headings), ("transfer", T), ("reference_point", point)):
            value.flags.writeable = False
            object.__setattr__(self, name, value)

    def matrix(self, omega: Array, heading: float) -> Complex:
        """T (n, n, 6) for all pairs of the frequencies omega (n,), rad/s, of waves of one heading, rad, relative to
        the body; NaN outside the range.

        Raises ModelError for a heading that is neither within 1 deg of one that is known nor between two.
        """
        p = self.omega.size
        i = np.clip(np.searchsorted(self.omega, omega, side="right") - 1, 0, p - 2)
        share = (omega - self.omega[i]) / np.diff(self.omega)[i]
        inside = (omega >= self.omega[0] * (1.0 - 1e-9)) & (omega <= self.omega[-1] * (1.0 + 1e-9))
        first, second = i[:, None], i[None, :]
        r, s = np.broadcast_arrays(share[:, None, None], share[None, :, None])
        low, high = np.minimum(r, s), np.maximum(r, s)
        out: Complex = np.zeros((len(omega), len(omega), 6), dtype=complex)
        for weight, k in self._between(heading):
            T = self.transfer[k]
            side = np.where(r >= s, T[first + 1, second], T[first, second + 1])
            for part, corner in ((1.0 - high, T[first, second]), (high - low, side), (low, T[first + 1, second + 1])):
                out += weight * np.where(part > 1e-12, part * corner, 0.0)  # a corner without weight may be unknown
        out[~(inside[:, None] & inside)] = np.nan
        return out

    def _between(self, heading: float) -> list[tuple[float, int]]:
        """(weight, index) of the headings that give T at `heading`, rad."""
        turn = (self.headings - heading + np.pi) % (2.0 * np.pi) - np.pi  # of each from the wave
        nearest = int(np.abs(turn).argmin())
        if abs(turn[nearest]) < 1e-6 or self.headings.size == 1 and abs(turn[0]) < _SAME:
            return [(1.0, nearest)]
        below = int(np.where(turn < 0.0, turn, -np.inf).argmax())
        above = int(np.where(turn > 0.0, turn, np.inf).argmin())
        if turn[below] < 0.0 < turn[above] and turn[above] - turn[below] < _APART:
            share = float(-turn[below] / (turn[above] - turn[below]))
            return [(1.0 - share, below), (share, above)]
        if abs(turn[nearest]) < _SAME:
            return [(1.0, nearest)]
        known = ", ".join(f"{math.degrees(h):g}" for h in self.headings)
        raise ModelError(
            f"QTF '{self.name}': waves at {math.degrees((heading + math.pi) % (2.0 * math.pi) - math.pi):.4g} deg "
            f"relative to the body, it is known at {known} deg (1 deg off is allowed, and what lies between two "
            "at most 30 deg apart); compute it for this heading, turn the waves or the body, or use drift='newman'"
        )


def _filled(T: Complex, kind: str, omega: Array, label: str) -> Complex:
    """Both halves of T from one of them, exactly symmetric."""
    other = np.swapaxes(T, 1, 2)
    other = other.conj() if kind == "difference" else other
    size = np.nanmax(np.abs(T), axis=(0, 1, 2), initial=0.0).reshape(2, 3).max(axis=1).repeat(3)
    gap = np.nan_to_num(np.abs(T - other)).max(axis=0)
    if np.any(gap > _UNEQUAL * size):
        m, n, d = np.unravel_index(int((gap / np.where(size > 0.0, size, 1.0)).argmax()), gap.shape)
        word = "conjugate to" if kind == "difference" else "equal to"
        raise ModelError(
            f"{label}: entry ({omega[m]:.4g}, {omega[n]:.4g}) rad/s of degree of freedom {d + 1} is not {word} entry "
            f"({omega[n]:.4g}, {omega[m]:.4g}), as a {kind} QTF must be; is the file of the other kind?"
        )
    both = 0.5 * (T + other)
    return np.where(np.isnan(T), other, np.where(np.isnan(other), T, both))


def read_wamit_qtf(
    path: str | Path,
    *,
    density: float,
    gravity: float,
    length: float = 1.0,
    body: int = 0,
    reference_point: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> QTF:
    """WAMIT's `.12d` (difference) or `.12s` (sum) of numeric output, possibly gzipped.

    Lines of PER1 PER2 BETA1 BETA2 I MOD PHASE RE IM: periods in s (WAMIT's default), headings in deg, force over
    rho g L, moment over rho g L^2, per product of amplitudes; time factor e^{+i w t} and phases at the global
    origin, floatsim's own. Pairs of different headings are left out: only waves of one heading meet here.

    density, gravity  kg/m3, m/s2, to give the numbers their dimensions
    length            ULEN, m
    body              index of the body, 0 the first, whose six degrees of freedom are read
    reference_point   WAMIT's body origin in the world frame (XBODY), m

    Raises ModelError naming file and line for what cannot be read, is double or missing.
    """
    path = Path(path)
    plain = path.with_suffix("") if path.suffix == ".gz" else path
    if plain.suffix not in (".12d", ".12s"):
        raise ModelError(f"'{path}': a WAMIT QTF ends in .12d (difference) or .12s (sum), possibly with .gz behind")
    if not path.is_file():
        raise ModelError(f"WAMIT file '{path}' does not exist")
    entries: dict[tuple[float, float, float], Complex] = {}
    seen: set[tuple[float, ...]] = set()
    for number, (first, second, beta1, beta2, dof, _, _, re, im) in _rows(path, (9,)):
        if first <= 0.0 or second <= 0.0:
            raise ModelError(f"{path}, line {number}: periods {first:g} and {second:g} s, must be positive")
        if dof < 1 or dof != int(dof):
            raise ModelError(f"{path}, line {number}: degree of freedom {dof:g}, must be 1, 2, ...")
        _once(path, number, seen, (first, second, beta1, beta2, dof))
        if not 6 * body < dof <= 6 * body + 6 or abs(beta1 - beta2) > 1e-6:
            continue
        heading = (beta1 + 180.0) % 360.0 - 180.0
        entry = entries.setdefault((first, second, heading), np.zeros(6, dtype=complex))
        entry[int(dof) - 1 - 6 * body] = complex(re, im)
    if not entries:
        raise ModelError(f"{path}: no entry of body {body + 1} for two waves of the same heading")
    periods = sorted({key[0] for key in entries} | {key[1] for key in entries}, reverse=True)
    headings = sorted({key[2] for key in entries})
    T: Complex = np.full((len(headings), len(periods), len(periods), 6), complex(np.nan))
    row, column = ({value: k for k, value in enumerate(axis)} for axis in (periods, headings))
    for (first, second, heading), entry in entries.items():
        T[column[heading], row[first], row[second]] = entry
    return QTF(
        name=path.name,
        kind="difference" if plain.suffix == ".12d" else "sum",
        omega=2.0 * np.pi / np.array(periods),
        headings=np.radians(headings),
        transfer=T * (density * gravity * length ** (1.0 + _ROTATION)).astype(complex),
        reference_point=np.array(reference_point),
        file=path,
    )
