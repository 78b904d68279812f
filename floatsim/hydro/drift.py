"""Second-order wave forces of one floater in one sea, of waves y_m(t) = a_m e^{i(w_m t + phase_m)} at the floater.

    full QTF   F = Re sum_m sum_n T(w_m, w_n) y_m conj(y_n)     difference frequencies
               F = Re sum_m sum_n T(w_m, w_n) y_m y_n           sum frequencies
    Newman     F = |sum_{D_m > 0} sqrt(D_m) y_m|^2 - |sum_{D_m < 0} sqrt(-D_m) y_m|^2

Both halves of the double sum are the same, so one is evaluated, exactly: with n waves n^2/2 terms per degree of
freedom. (Interpolated between frequencies, T has nearly full rank: a factorisation would cost more.)

Newman (1974) replaces T(w_m, w_n) by mean drifts, D_m = T(w_m, w_m). Here by their geometric mean where they have
one sign and by zero where they have not (Standing, Brendling & Wilson 1987): the mean is exact, the cost grows with
n, and there is no spurious force at the sum frequencies; what the second-order potential and the phase of T add at
a finite difference of frequencies is missing, which is most of the pitch moment of a semi-submersible. In a
short-crested sea D_m is taken at each wave's own heading, and waves of different headings beat as if they had
one: the slow force is then too large, the mean is not.

A mean drift is linear between the frequencies of the database and from zero at frequency zero, and over the headings
as the excitation is (excitation.py).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError
from floatsim.hydro.excitation import at_headings
from floatsim.hydro.qtf import QTF
from floatsim.jit import kernel
from floatsim.sea.waves import Realisation

if TYPE_CHECKING:
    from floatsim.hydro.database import HydroDatabase

Array = NDArray[np.float64]

Drift = Literal["newman"] | QTF
_ALONE = 1e-3  # rad: waves closer in heading than this are one long-crested sea
_MOST = 2000  # waves: their pairs take 0.2 GB and 5 ms a step
_NOISE = 1e-6  # of the largest entry: degrees of freedom below it are noise of a symmetric hull, and zero


class SecondOrder(Protocol):
    """A second-order force at one heading of the floater, in the floater's horizontal frame."""

    mean: Array  # (6,) N, N m: over all time

    def add(self, y: Array, out: Array) -> None:
        """Add force and moment (6,) by the waves y (2, n), real and imaginary parts, m."""


class PairSum:
    """Full QTF in a long-crested sea.

    mean      (6,) sum of a_m^2 T(w_m, w_m), zero of a sum QTF
    left_out  share of the products of the waves' energies for which the QTF is not known and taken as zero
    """

    def __init__(self, qtf: QTF, sea: Realisation, heading: float) -> None:
        """heading: of the floater, rad. Raises ModelError for a short-crested sea, headings the QTF lacks and more
        than 2000 waves."""
        if sea.omega.size > _MOST:
            raise ModelError(
                f"QTF '{qtf.name}': the sea has {sea.omega.size} waves, at most {_MOST} can be taken in pairs; use "
                "fewer (200 have the statistics of slow forces within 1 %), or drift='newman'"
            )
        spread = np.abs((sea.heading - sea.heading[0] + np.pi) % (2.0 * np.pi) - np.pi).max()
        if spread > _ALONE:
            raise ModelError(
                f"QTF '{qtf.name}': the waves differ in heading by up to {math.degrees(spread):.3g} deg, a full QTF is "
                "used for long-crested seas only; leave out the spreading, or use drift='newman'"
            )
        T = qtf.matrix(sea.omega, float(sea.heading[0]) - heading)
        unknown = np.isnan(T[..., 0])
        T = np.where(np.isnan(T), 0.0, T)
        energy = sea.amplitude**2
        total = max(float(energy.sum()) ** 2, np.finfo(float).tiny)
        self.left_out = float(energy @ unknown @ energy) / total
        size = np.abs(T).max(axis=(0, 1)).reshape(2, 3)
        kept = (size > _NOISE * size.max(axis=1, keepdims=True)).ravel()
        self._sign = -1.0 if qtf.kind == "difference" else 1.0  # of the second wave's imaginary part
        self.mean = np.zeros(6)
        if qtf.kind == "difference":
            self.mean = np.where(kept, np.einsum("m,mmd->d", energy, T).real, 0.0)
        self._waves = np.flatnonzero(~unknown.all(axis=1))
        self._dofs = np.flatnonzero(kept)
        rows, columns = np.tril_indices(self._waves.size)
        pairs = T[self._waves[rows], self._waves[columns]][:, self._dofs].T * np.where(rows == columns, 1.0, 2.0)
        self._table = np.ascontiguousarray(np.stack([pairs.real, -pairs.imag], axis=1))
        self._scratch = np.zeros((4, max(self._waves.size, 1)))

    def add(self, y: Array, out: Array) -> None:
        _pair_sum(y, self._waves, self._dofs, self._sign, self._table, self._scratch, out)


class Newman:
    """Newman's approximation. mean (6,): sum of a_m^2 D_m."""

    left_out = 0.0

    def __init__(self, drift: Array, sea: Realisation) -> None:
        """drift (n, 6): D of each wave, N/m2 and N m/m2."""
        self.mean = sea.amplitude**2 @ drift
        self._roots = np.ascontiguousarray((np.sign(drift) * np.sqrt(np.abs(drift))).T)

    def add(self, y: Array, out: Array) -> None:
        _newman(y, self._roots, out)


def mean_drifts(db: HydroDatabase, sea: Realisation, body: int = 0) -> Array:
    """Mean drift (n, m, 6) of `body` by each of the sea's n waves at the database's m headings, N/m2 and N m/m2; zero
    above its frequencies. Raises ModelError if it knows none."""
    if db.mean_drift is None:
        raise ModelError(
            f"hydrodynamic database '{db.name}': it has no mean drift, which drift='newman' is made from; compute it "
            "(compute_database(drift=FreeFloating(...)), 'floatsim hydro compute'; WAMIT: .8 or .9 file; BEMIO), or "
            "give a QTF"
        )
    omega = np.concatenate([[0.0], db.omega])
    known = db.mean_drift[:, :, 6 * body : 6 * body + 6]
    table = np.concatenate([np.zeros((1, *known.shape[1:])), known])
    i = np.clip(np.searchsorted(omega, sea.omega, side="right") - 1, 0, omega.size - 2)
    share = ((sea.omega - omega[i]) / np.diff(omega)[i])[:, None, None]
    out = (1.0 - share) * table[i] + share * table[i + 1]
    out[sea.omega > db.omega[-1]] = 0.0
    return out


def newman(db: HydroDatabase, known: Array, sea: Realisation, heading: float) -> Newman:
    """Newman's approximation for a floater at `heading`, rad; known (n, m, 6) from `mean_drifts`."""
    return Newman(at_headings(db, known, sea.heading - heading, sea.amplitude).real, sea)


@kernel(fastmath={"reassoc", "contract"})
def _pair_sum(y, waves, dofs, sign, table, scratch, out):  # type: ignore[no-untyped-def]
    """out += Re sum over m >= n of T_mn y_m (y_n or its conjugate); table (d, 2, n(n+1)/2): Re T, -Im T, row by row."""
    for m in range(waves.shape[0]):
        scratch[0, m] = y[0, waves[m]]
        scratch[1, m] = sign * y[1, waves[m]]
    k = 0
    for m in range(waves.shape[0]):
        re, im = scratch[0, m], sign * scratch[1, m]
        for n in range(m + 1):
            scratch[2, n] = re * scratch[0, n] - im * scratch[1, n]
            scratch[3, n] = re * scratch[1, n] + im * scratch[0, n]
        for d in range(dofs.shape[0]):
            total = 0.0
            for n in range(m + 1):
                total += table[d, 0, k + n] * scratch[2, n] + table[d, 1, k + n] * scratch[3, n]
            out[dofs[d]] += total
        k += m + 1


@kernel(fastmath={"reassoc", "contract"})
def _newman(y, roots, out):  # type: ignore[no-untyped-def]
    """out += |sum of positive roots y|^2 - |sum of negative roots y|^2; roots (6, n) with the sign of the drift."""
    for d in range(6):
        a = b = p = q = 0.0
        for n in range(roots.shape[1]):
            r = roots[d, n]
            high, low = max(r, 0.0), min(r, 0.0)
            a += high * y[0, n]
            b += high * y[1, n]
            p += low * y[0, n]
            q += low * y[1, n]
        out[d] += a * a + b * b - p * p - q * q
