"""Does a hydrodynamic database make sense? Physical checks, each with a sentence that says what was found.

The laws hold for any body in linear potential flow, so that they find wrong signs, units, scaling and phase origins,
coarse meshes and irregular frequencies, whatever code the numbers come from.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from floatsim.hydro.conventions import ESTIMATED
from floatsim.hydro.database import DOF_NAMES, HydroDatabase, added_mass_from_damping
from floatsim.sea.dispersion import wave_number

_COARSE = np.radians(20.01)  # headings further apart do not tell the energy of the waves between them


@dataclass(frozen=True)
class Finding:
    """One check of a database: what was looked at, what was measured, what is allowed, in words."""

    severity: Literal["ok", "warning", "error"]
    quantity: str
    measured: float
    allowed: float
    message: str


def check_database(db: HydroDatabase) -> tuple[Finding, ...]:
    """Physical consistency of a database; every check gives a finding, also when it is passed.

    - finite numbers (if not, nothing else is looked at),
    - symmetry of A, B, A_inf and C, between bodies too; entries are scaled by the diagonal,
    - B positive semi-definite: waves carry energy away,
    - A(w) - A_inf = 2/pi P int B(s) / (s^2 - w^2) ds (Ogilvie 1964), over w <= w_max / 2,
    - heave excitation at the lowest frequency, under a crest above the body, against rho g A_wp - w^2 (rho V + A33):
      a small body in long waves feels the moving water (Newman, Marine Hydrodynamics, 1977),
    - excitation along the wave there against the water's acceleration times (rho V + A), and the Froude-Krylov part
      against rho V alone and the waterplane: a body in long waves feels a pressure gradient,
    - B_ii = k / (8 pi rho g c_g) int |X_i|^2 d(heading): what is radiated is what would excite (Newman 1977),
      where headings cover the circle,
    - A_ii and B_ii are smooth over the frequencies: an irregular frequency stands out from its neighbours,
    - frequencies and headings cover what time-domain forces need,
    - mean drift of one body, where it is known, pushes it along the waves, never against them: what it sends away it
      has taken from the incident wave (Maruo 1960).
    """
    bad = [item.name for item in fields(db) if _not_finite(getattr(db, item.name))]
    if bad:
        return (
            Finding("error", "finite numbers", len(bad), 0, f"NaN or infinite values in {', '.join(bad)}"),
        )
    findings = [Finding("ok", "finite numbers", 0, 0, "no NaN, no infinite value")]
    mass, damping = _mass_scale(db), _damping_scale(db)
    stiffness = np.sqrt(_per_dof(db, db.density * db.gravity * db.volume ** (2.0 / 3.0)))
    # buoyancy beside the reference point turns with the yaw: C46 = -rho g V x_B, C56 = -rho g V y_B stand alone
    tilting = db.hydrostatic_stiffness.copy()
    for yaw in range(5, len(tilting), 6):
        tilting[yaw - 2 : yaw, yaw] = tilting[yaw, yaw - 2 : yaw]
    for label, matrix, scale in (
        ("added mass", db.added_mass, mass),
        ("radiation damping", db.radiation_damping, damping),
        ("added mass at infinite frequency", db.added_mass_inf, mass),
        ("hydrostatic stiffness", tilting, stiffness),
    ):
        findings.append(_symmetry(db, label, matrix, scale))
    findings.append(_positive_damping(db, damping))
    findings.append(_infinite_frequency(db, mass))
    for k in range(len(db.bodies)):
        findings += [_long_wave_heave(db, k), _long_wave_surge(db, k)]
    if db.froude_krylov is not None:
        findings += [_froude_krylov(db, k) for k in range(len(db.bodies))]
    findings.append(_radiated_energy(db, damping))
    findings.append(_spikes(db, mass, damping))
    findings.append(_highest_frequency(db))
    findings.append(_frequency_step(db))
    findings.append(_heading_step(db))
    if db.mean_drift is not None and len(db.bodies) == 1:
        findings.append(_mean_drift(db, db.mean_drift))
    return tuple(findings)


def _not_finite(value: Any) -> bool:
    return isinstance(value, np.ndarray) and not bool(np.all(np.isfinite(value)))


def _diagonal_max(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.abs(np.diagonal(matrices, axis1=-2, axis2=-1)).max(axis=0)


def _mass_scale(db: HydroDatabase) -> NDArray[np.float64]:
    """(d,) square roots of typical diagonal entries; never zero (yaw of a body of revolution)."""
    floor = 1e-3 * _per_dof(db, db.density * db.volume)
    return np.sqrt(np.maximum(_diagonal_max(db.added_mass), floor))


def _per_dof(db: HydroDatabase, size: NDArray[np.float64]) -> NDArray[np.float64]:
    """(d,) from one number per body (N,): as it is for translations, times a length squared for rotations."""
    rotations = size * db.volume ** (2.0 / 3.0)
    return np.stack([size, size, size, rotations, rotations, rotations], axis=1).ravel()


def _damping_scale(db: HydroDatabase) -> NDArray[np.float64]:
    size = np.maximum(_mass_scale(db) ** 2, _per_dof(db, db.density * db.volume))  # yaw of a polygon is next to nothing
    floor = 1e-4 * size * db.omega[-1]
    return np.sqrt(np.maximum(_diagonal_max(db.radiation_damping), floor))


def _dof(db: HydroDatabase, i: int) -> str:
    return (f"{db.bodies[i // 6]} " if len(db.bodies) > 1 else "") + DOF_NAMES[i % 6].lower()


def _pair(db: HydroDatabase, i: int, j: int) -> str:
    return f"{_dof(db, i)}-{_dof(db, j)}"


def _graded(quantity: str, measured: float, warn: float, fail: float, good: str, bad: str) -> Finding:
    """`measured` should be small: ok up to `warn`, a warning up to `fail`, an error beyond."""
    severity: Literal["ok", "warning", "error"] = (
        "ok" if measured <= warn else "warning" if measured <= fail else "error"
    )
    return Finding(severity, quantity, float(measured), warn, good if severity == "ok" else bad)


def _symmetry(db: HydroDatabase, label: str, matrix: NDArray[np.float64], scale: NDArray[np.float64]) -> Finding:
    error = np.abs(matrix - np.swapaxes(matrix, -1, -2)) / np.outer(scale, scale)
    error = error.reshape(-1, *error.shape[-2:]).max(axis=0)
    i, j = (int(k) for k in np.unravel_index(np.argmax(error), error.shape))
    size = error[i, j]
    good = f"{label} is symmetric within {100 * size:.2g} % of its diagonal"
    bad = (
        f"{label}: {_pair(db, i, j)} and {_pair(db, j, i)} differ by {100 * size:.2g} % of the diagonal; "
        "refine the mesh, or see whether rows and columns are mixed up or moments are about another point"
    )
    return _graded(f"symmetry of {label}", size, 0.03, 0.15, good, bad)


def _positive_damping(db: HydroDatabase, scale: NDArray[np.float64]) -> Finding:
    b = db.radiation_damping / np.outer(scale, scale)
    lowest = np.linalg.eigvalsh(0.5 * (b + np.swapaxes(b, -1, -2)))[:, 0]
    k = int(np.argmin(lowest))
    size = max(0.0, -float(lowest[k]))
    good = f"radiation takes energy out at every frequency (worst {100 * size:.2g} % of the peak)"
    bad = (
        f"at {db.omega[k]:.3g} rad/s radiation damping feeds energy in, {100 * size:.2g} % of the peak: "
        "irregular frequencies (mesh the lid) or a coarse mesh"
    )
    return _graded("positive damping", size, 0.01, 0.05, good, bad)


def _infinite_frequency(db: HydroDatabase, scale: NDArray[np.float64]) -> Finding:
    implied = db.added_mass - added_mass_from_damping(db.omega, db.radiation_damping)
    low = db.omega <= 0.5 * db.omega[-1]
    error = np.sqrt(np.mean((implied[low] - db.added_mass_inf) ** 2, axis=0)) / np.outer(scale, scale)
    i, j = (int(k) for k in np.unravel_index(np.argmax(error), error.shape))
    size = error[i, j]
    text = (
        f"A_inf {_pair(db, i, j)} is {db.added_mass_inf[i, j]:.4g}, A(w) and B(w) imply "
        f"{implied[low, i, j].mean():.4g} (rms difference {100 * size:.2g} % of the diagonal)"
    )
    hint = "; A_inf of another case, frequencies that end too early or are too far apart"
    if db.source.get("added_mass_inf") == ESTIMATED:
        text = f"A_inf was not computed but taken {ESTIMATED}; {text}"
        size = max(size, np.nextafter(0.02, 1.0))  # never more than a warning's worth of trust
        hint = "; compute infinite frequency too"
    return _graded("added mass at infinite frequency", size, 0.02, 0.1, text, text + hint)


def _long_wave_heave(db: HydroDatabase, body: int) -> Finding:
    label = "long-wave heave excitation" + _of(db, body)
    heave = 6 * body + 2
    w, stiffness = db.omega[0], db.hydrostatic_stiffness[heave, heave]
    if stiffness < 1e-3 * db.density * db.gravity * db.volume[body] ** (2.0 / 3.0):
        return Finding("ok", label, 0.0, 0.0, "not looked at: the body has no waterplane")
    # in long waves all bodies' water moves alike: the added mass of one is that of its row
    inertia = w**2 * (db.density * db.volume[body] + db.added_mass[0, heave, 2::6].sum())
    allowed = 0.02 + 0.5 * inertia / stiffness
    if allowed > 0.25:
        text = f"not looked at: at the lowest frequency, {w:.3g} rad/s, waves are not long enough"
        return Finding("warning", label, 0.0, 0.25, text)
    force = db.excitation[0, :, heave] / _crest(db)[body]
    error = np.abs(force - (stiffness - inertia)) / stiffness
    k = int(np.argmax(error))
    got, size = force[k], float(error[k])
    text = (
        f"at {w:.3g} rad/s, heading {np.degrees(db.headings[k]):.0f} deg, X3 is {got.real:.4g} "
        f"{got.imag:+.2g}i N/m, the waterplane says {stiffness - inertia:.4g}"
    )
    hint = "; check the scaling by rho g, the time sign, and where phases are measured from"
    return _graded(label, size, allowed, 2.0 * allowed, text, text + hint)


def _of(db: HydroDatabase, body: int) -> str:
    return f" of {db.bodies[body]}" if len(db.bodies) > 1 else ""


def _accelerations(db: HydroDatabase) -> tuple[float, NDArray[np.complex128]]:
    """Wave number k at the lowest frequency and, for a wave of 1 m, the water's horizontal acceleration (N, m) along
    it at the centres of buoyancy: i g k cosh k(z + h) / cosh k h e^{-i k (x cos b + y sin b)}."""
    k = float(wave_number(db.omega[0], db.depth, db.gravity))
    z, h = db.centre_of_buoyancy[:, 2:], db.depth
    fade = np.exp(k * z) if np.isinf(h) else np.cosh(k * np.maximum(z + h, 0.0)) / np.cosh(min(k * h, 300.0))
    return k, 1j * db.gravity * k * fade * _crest(db)


def _crest(db: HydroDatabase) -> NDArray[np.complex128]:
    """Elevation (N, m) of the lowest frequency's waves above the bodies: e^{-i k (x cos b + y sin b)}."""
    x, y = db.centre_of_buoyancy.T[:2, :, None]
    k = wave_number(db.omega[0], db.depth, db.gravity)
    return np.asarray(np.exp(-1j * k * (x * np.cos(db.headings) + y * np.sin(db.headings))))


def _along(force: NDArray[np.complex128], headings: NDArray[np.float64], body: int) -> NDArray[np.complex128]:
    """Component of the horizontal force (m, d) on a body along each wave."""
    return force[:, 6 * body] * np.cos(headings) + force[:, 6 * body + 1] * np.sin(headings)


def _ratio(db: HydroDatabase, label: str, got: Any, wanted: Any, allowed: float, what: str) -> Finding:
    """got and wanted (m,) complex should be the same."""
    ratio = got / wanted
    j = int(np.argmax(np.abs(ratio - 1.0)))
    size = float(np.abs(ratio[j] - 1.0))
    turned = np.degrees(np.angle(ratio[j]))
    text = (
        f"at {db.omega[0]:.3g} rad/s, heading {np.degrees(db.headings[j]):.0f} deg, it is {abs(ratio[j]):.3g} times "
        f"what {what}" + ("" if abs(turned) < 0.05 else f", {turned:+.3g} deg away in phase")
    )
    hint = "; check the depth, the time sign, the direction of headings, where phases are measured from, the scaling"
    return _graded(label, size, allowed, 2.0 * allowed, text, text + hint)


def _pushed(
    db: HydroDatabase, label: str, body: int, force: NDArray[np.complex128], wanted: NDArray[np.complex128],
    allowed: float, what: str,
) -> Finding:  # fmt: skip
    """Horizontal force (m, d) along the wave on one body against `wanted` (N, m)."""
    along = np.stack([_along(force, db.headings, k) for k in range(len(db.bodies))])
    one = _ratio(db, label, along[body], wanted[body], allowed, what)
    if one.severity != "ok" and len(db.bodies) > 1:
        whole = _ratio(db, label, along.sum(axis=0), wanted.sum(axis=0), allowed, what)
        if whole.severity == "ok":
            text = (
                f"{one.message.split(';')[0]}, but on all bodies together it is right within "
                f"{100 * whole.measured:.2g} %: walls that bodies share were left out of the mesh, so that the force "
                "is split differently"
            )
            return replace(one, severity="warning", message=text)
    return one


def _long_wave_surge(db: HydroDatabase, body: int) -> Finding:
    label = "long-wave surge and sway excitation" + _of(db, body)
    k, water = _accelerations(db)
    allowed = 0.05 + 2.0 * k * float(np.max(db.volume)) ** (1.0 / 3.0)
    if allowed > 0.35:
        text = f"not looked at: at the lowest frequency, {db.omega[0]:.3g} rad/s, waves are not long enough"
        return Finding("warning", label, 0.0, 0.35, text)
    N = len(db.bodies)
    A = db.added_mass[0].reshape(N, 6, N, 6)[:, :2, :, :2]
    b = np.stack([np.cos(db.headings), np.sin(db.headings)])
    wanted = db.density * db.volume[:, None] * water + np.einsum("im,kinj,jm,nm->km", b, A, b, water)
    return _pushed(db, label, body, db.excitation[0], wanted, allowed, "the water's acceleration gives")


def _froude_krylov(db: HydroDatabase, body: int) -> Finding:
    assert db.froude_krylov is not None
    label = "long-wave Froude-Krylov force" + _of(db, body)
    k, water = _accelerations(db)
    allowed = 0.05 + 2.0 * k * float(np.max(db.volume)) ** (1.0 / 3.0)
    if allowed > 0.35:
        text = f"not looked at: at the lowest frequency, {db.omega[0]:.3g} rad/s, waves are not long enough"
        return Finding("warning", label, 0.0, 0.35, text)
    displaced = db.density * db.volume[:, None]
    surge = _pushed(
        db, label, body, db.froude_krylov[0], displaced * water, allowed, "the displaced water gives along the wave"
    )
    heave = 6 * body + 2
    plane = db.hydrostatic_stiffness[heave, heave] - displaced[body] * db.omega[0] ** 2
    if plane < 0.5 * db.hydrostatic_stiffness[heave, heave] or surge.severity != "ok":
        return surge
    lift = _ratio(
        db, label, db.froude_krylov[0, :, heave], plane * _crest(db)[body], allowed, "the waterplane gives in heave"
    )
    return lift if lift.measured > surge.measured else surge


def _radiated_energy(db: HydroDatabase, scale: NDArray[np.float64]) -> Finding:
    label = "radiated energy"
    gaps = np.diff(db.headings, append=db.headings[0] + 2.0 * np.pi)
    if gaps.max() > _COARSE:
        text = "not looked at: headings further apart than 20 deg, or not all around the circle"
        return Finding("ok", label, 0.0, 0.0, text)
    weight = 0.5 * (gaps + np.roll(gaps, 1))
    k = wave_number(db.omega, db.depth, db.gravity)
    kh = np.minimum(k * db.depth, 300.0)
    group = 0.5 * db.omega / k * (1.0 + 2.0 * kh / np.sinh(2.0 * kh))
    # the force over the heading has harmonics up to about k times the extent of all bodies
    centres = db.centre_of_buoyancy[:, :2]
    apart = float(np.linalg.norm(centres - centres.mean(axis=0), axis=1).max())
    extent = 2.0 * float(np.max(db.volume)) ** (1.0 / 3.0) + apart
    low = k * extent < 0.5 * np.pi / gaps.max()
    if not np.any(low):
        return Finding("ok", label, 0.0, 0.0, "not looked at: headings too far apart for such short waves")
    energy = np.einsum("nmi,m->ni", np.abs(db.excitation) ** 2, weight)
    radiated = (k / (8.0 * np.pi * db.density * db.gravity * group))[:, None] * energy
    damping = np.diagonal(db.radiation_damping, axis1=1, axis2=2)
    error = np.abs(damping - radiated)[low] / scale**2
    n, i = (int(a) for a in np.unravel_index(np.argmax(error), error.shape))
    size = error[n, i]
    text = (
        f"at {db.omega[low][n]:.3g} rad/s, {_dof(db, i)} damping is {damping[low][n, i]:.4g}, the waves that excite it "
        f"take {radiated[low][n, i]:.4g} (difference {100 * size:.2g} % of its peak)"
    )
    hint = "; excitation and damping of different cases, scaled apart, or a coarse mesh"
    return _graded(label, size, 0.08, 0.3, text, text + hint)


def _spikes(db: HydroDatabase, mass: NDArray[np.float64], damping: NDArray[np.float64]) -> Finding:
    """How far A_ii and B_ii stand off the cubic through two neighbours on either side, where these do not themselves
    stand off a curve that leaves the value out, and the curve is smooth around: an error at one frequency, not one of
    the resonances of the water between columns."""
    label = "irregular frequencies"
    if db.omega.size < 9:
        return Finding("ok", label, 0.0, 0.0, "not looked at: fewer than nine frequencies")
    smooth = "added mass and damping have no jumps at single frequencies"
    worst, text = 0.0, smooth
    for name, values, scale in (("added mass", db.added_mass, mass), ("damping", db.radiation_damping, damping)):
        y = np.diagonal(values, axis1=1, axis2=2) / scale**2
        off = _off_cubic(db.omega, y, 0, (-2, -1, 1, 2))
        before, after = _off_cubic(db.omega, y, -1, (-3, -2, 1, 2)), _off_cubic(db.omega, y, 1, (-2, -1, 2, 3))
        padded = np.pad(off, ((6, 6), (0, 0)), mode="reflect") if len(off) > 6 else np.pad(off, ((6, 6), (0, 0)))
        around = np.median([padded[6 + s : 6 + s + len(off)] for s in (-6, -5, -4, -3, 3, 4, 5, 6)], axis=0)
        alone = np.where(off > np.maximum(4.0 * np.maximum(before, after), 6.0 * around), off, 0.0)
        n, i = (int(a) for a in np.unravel_index(np.argmax(alone), alone.shape))
        if alone[n, i] > worst:
            worst = float(alone[n, i])
            text = f"{_dof(db, i)} {name} jumps by {100 * worst:.2g} % of its peak at {db.omega[n + 3]:.4g} rad/s"
    hint = (
        "; an irregular frequency (mesh the lid), a failed run, or a resonance in a narrow gap that frequencies so far "
        "apart do not resolve"
    )
    return _graded(label, worst, 0.03, np.inf, smooth, text + hint)


def _off_cubic(
    w: NDArray[np.float64], y: NDArray[np.float64], at: int, through: tuple[int, ...]
) -> NDArray[np.float64]:
    """Distance (n - 6, d) of y (n, d) at place k + at from the cubic through k + through, for k = 3 .. n - 4."""
    k = np.arange(3, w.size - 3)[:, None]
    places = k + np.array(through)
    x, x0 = w[places], w[k + at]
    one = np.eye(4)
    above = np.prod((x0[:, :, None] - x[:, None, :]) * (1.0 - one) + one, axis=2)
    below = np.prod((x[:, :, None] - x[:, None, :]) * (1.0 - one) + one, axis=2)
    return np.abs(y[k[:, 0] + at] - np.einsum("nk,nki->ni", above / below, y[places]))


def _highest_frequency(db: HydroDatabase) -> Finding:
    share = _diagonal_max(db.radiation_damping[-1:]) / _damping_scale(db) ** 2
    i = int(np.argmax(share))
    size = float(share[i])
    text = (
        f"at the highest frequency, {db.omega[-1]:.3g} rad/s, {_dof(db, i)} damping is down to "
        f"{100 * size:.2g} % of its peak"
    )
    hint = "; the radiation memory will ring: compute higher frequencies, until damping has faded"
    return _graded("highest frequency", size, 0.1, 0.5, text, text + hint)


def _frequency_step(db: HydroDatabase) -> Finding:
    # damping starts flat from zero, so that the first step may be twice as long
    size = float(max(np.max(np.diff(db.omega)), 0.5 * db.omega[0]))
    # the memory lasts as long as waves of the body's own length take to leave: 0.05 rad/s for a hull of 20000 m3
    fine = 0.0835 * float(np.sqrt(db.gravity / np.max(db.volume) ** (1.0 / 3.0)))
    text = f"frequencies at most {size:.3g} rad/s apart: good for a radiation memory of {np.pi / size:.3g} s"
    hint = f"; {fine:.2g} rad/s or finer is needed for {np.pi / fine:.3g} s"
    return _graded("frequency step", size, fine, 5.0 * fine, text, text + hint)


def _heading_step(db: HydroDatabase) -> Finding:
    around = np.diff(db.headings, append=db.headings[0] + 2.0 * np.pi)
    size = float(np.degrees(np.max(around)))
    if db.headings.size == 1:
        text = (
            f"only heading {np.degrees(db.headings[0]):g} deg is there: waves of any other will be refused; compute "
            "the circle in steps of 10 deg for those"
        )
        return Finding("warning", "heading step", 360.0, 10.01, text)
    text = f"headings at most {size:.3g} deg apart around the circle"
    hint = (
        "; waves between headings further apart than 10 deg cannot be interpolated: compute them, or mirror those "
        "there are if the body is symmetric"
    )
    return _graded("heading step", size, 10.01, 360.0, text, text + hint)


def _mean_drift(db: HydroDatabase, drift: NDArray[np.float64]) -> Finding:
    along = drift[:, :, 0] * np.cos(db.headings) + drift[:, :, 1] * np.sin(db.headings)
    largest = max(float(np.abs(drift[:, :, :2]).max()), np.finfo(float).tiny)
    size = max(0.0, -float(along.min()) / largest)
    n, j = (int(a) for a in np.unravel_index(np.argmin(along) if size > 0.02 else np.argmax(along), along.shape))
    where = f"at {db.omega[n]:.3g} rad/s, heading {np.degrees(db.headings[j]):.0f} deg"
    text = f"mean drift pushes along the waves, up to {along[n, j]:.4g} N/m2 {where}"
    if "mean_drift_motions" in db.source:
        text += f" (motions: {db.source['mean_drift_motions']})"
    if "mean_drift_energy_error" in db.source:
        share = 100.0 * float(db.source["mean_drift_energy_error"])
        text += f"; energies that the wave loses and the body sends off agree within {share:.2g} %"
    bad = (
        f"mean drift pulls against the waves with {-along[n, j]:.4g} N/m2 {where}, {100 * size:.2g} % of its largest; "
        "no body alone does that: check signs and headings, or take the drift by momentum instead of by pressure"
    )
    return _graded("mean drift", size, 0.02, np.inf, text, bad)
