"""The hydrodynamic database of floaters: what linear potential flow says about one, or about several that interact.

One class, `HydroDatabase`, whatever the numbers came from. It holds everything in floatsim's own
conventions, so nothing behind a reader ever converts again:

- time factor e^{+i w t}: a force is Re(X a e^{i w t}) for the wave
  eta = Re(a e^{i(w t - k(x cos b + y sin b))}); the phase is zero when a crest passes the origin of
  the world frame, not the reference point,
- headings are the directions towards which waves travel, counter-clockwise from +x,
- forces and moments along the world axes at the drawing position, moments about `reference_point`,
- radiation force = -A(w) xi'' - B(w) xi' (Cummins 1962; Ogilvie 1964).

The file is netCDF with the names that Capytaine uses. It carries its bodies along a dimension `body` and its degrees
of freedom along `influenced_dof` and `radiating_dof`, six per body, one body after the other; those of several bodies
are called BODY__Surge and so on.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from floatsim.errors import ModelError

_KINDS = {"excitation": np.complex128, "froude_krylov": np.complex128, "hull_faces": np.int64, "hull_body": np.int64}
_PER_BODY = {"volume": 1, "centre_of_buoyancy": 2, "reference_point": 2}  # dimensions, the first of them bodies
DOF_NAMES = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
_PHASE_ORIGIN = "world origin"
_PLUS, _MINUS = "exp(+i omega t)", "exp(-i omega t)"  # values of the file's attribute `time_sign`


@dataclass(frozen=True, eq=False, kw_only=True)
class HydroDatabase:
    """Hydrodynamic coefficients of N interacting floaters, each about its `reference_point`. Arrays are read-only.

    Degrees of freedom, d = 6 N: surge, sway, heave, roll, pitch, yaw of each body along world axes (rotations in rad).

    name                   what messages call it (a file name, usually)
    bodies                 names of the bodies; default, for one body: its name
    omega                  (n,) rad/s, increasing, finite and positive
    added_mass             (n, d, d) kg, kg m, kg m2: [i, j] is the force i per acceleration j
    radiation_damping      (n, d, d) N s/m, N s, N m s
    added_mass_inf         (d, d) added mass at infinite frequency
    added_mass_zero        (d, d) at zero frequency, or None
    headings               (m,) rad in [-pi, pi), increasing
    excitation             (n, m, d) complex, N/m and N m/m, Froude-Krylov + diffraction
    froude_krylov          (n, m, d) complex, its part by the undisturbed wave alone, or None
    mean_drift             (n, m, d) N/m2 and N m/m2: mean second-order force per wave amplitude squared, or None
    hydrostatic_stiffness  (d, d) waterplane + rho g V z_B, without weight; bodies do not act on each other
    volume                 (N,) m3, displaced at the drawing position
    centre_of_buoyancy     (N, 3) m, world frame
    reference_point        (N, 3) m, world frame (origin at mean sea level)
    depth                  m, inf for deep water
    density, gravity       kg/m3, m/s2
    hull_vertices, hull_faces  (p, 3) m and (q, 4) indices of the panel mesh, or None
    hull_body              (q,) index of the body each face belongs to, or None
    source                 what made the numbers: code, version, settings, mesh hash

    Of one body a single volume and points (3,) will do.

    Raises ModelError, all problems at once, for shapes that do not fit and unordered axes. Whether
    the numbers make sense is the business of `check_database`.
    """

    name: str
    omega: NDArray[np.float64]
    added_mass: NDArray[np.float64]
    radiation_damping: NDArray[np.float64]
    added_mass_inf: NDArray[np.float64]
    headings: NDArray[np.float64]
    excitation: NDArray[np.complex128]
    hydrostatic_stiffness: NDArray[np.float64]
    volume: NDArray[np.float64]
    centre_of_buoyancy: NDArray[np.float64]
    reference_point: NDArray[np.float64]
    depth: float
    density: float
    gravity: float
    bodies: tuple[str, ...] = ()
    added_mass_zero: NDArray[np.float64] | None = None
    froude_krylov: NDArray[np.complex128] | None = None
    mean_drift: NDArray[np.float64] | None = None
    hull_vertices: NDArray[np.float64] | None = None
    hull_faces: NDArray[np.int64] | None = None
    hull_body: NDArray[np.int64] | None = None
    source: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if value is None or item.name in ("name", "source", "bodies"):
                continue
            if item.name in ("depth", "density", "gravity"):
                value = float(value)
            else:
                value = np.array(value, dtype=_KINDS.get(item.name, np.float64), order="C")
                if value.ndim < _PER_BODY.get(item.name, 0):
                    value = value[None]
                value.flags.writeable = False
            object.__setattr__(self, item.name, value)
        object.__setattr__(self, "bodies", tuple(self.bodies) or (self.name,))
        object.__setattr__(self, "source", MappingProxyType(dict(self.source)))
        problems = self._problems()
        if problems:
            raise ModelError(problems)

    def _problems(self) -> list[str]:
        label = f"hydrodynamic database '{self.name}'"
        n, m, N = self.omega.size, self.headings.size, len(self.bodies)
        d = 6 * N
        wanted: dict[str, tuple[int, ...]] = {
            "omega": (n,),
            "headings": (m,),
            "added_mass": (n, d, d),
            "radiation_damping": (n, d, d),
            "added_mass_inf": (d, d),
            "added_mass_zero": (d, d),
            "excitation": (n, m, d),
            "froude_krylov": (n, m, d),
            "mean_drift": (n, m, d),
            "hydrostatic_stiffness": (d, d),
            "volume": (N,),
            "centre_of_buoyancy": (N, 3),
            "reference_point": (N, 3),
        }
        problems = []
        for key, shape in wanted.items():
            value = getattr(self, key)
            if value is not None and value.shape != shape:
                problems.append(
                    f"{label}: {key} has shape {value.shape}, must be {shape} "
                    f"({n} frequencies, {m} headings, {_bodies(N)})"
                )
        for name, times in Counter(self.bodies).items():
            if times > 1:
                problems.append(f"{label}: {times} bodies are called '{name}'; names must differ")
        if n < 2 or not (
            np.all(np.isfinite(self.omega)) and self.omega.min() > 0.0 and np.all(np.diff(self.omega) > 0.0)
        ):
            problems.append(
                f"{label}: omega must be at least two finite positive frequencies, "
                "increasing (zero and infinite frequency have places of their own)"
            )
        h = self.headings
        if m < 1 or not (
            np.all(np.abs(h) < np.pi + 1e-9)
            and np.all(np.diff(h) > 0.0)
            and h[-1] - h[0] < 2.0 * np.pi - 1e-6
        ):
            problems.append(f"{label}: headings must be at least one, in [-pi, pi), increasing")
        for key in ("depth", "density", "gravity"):
            if not getattr(self, key) > 0.0:
                problems.append(f"{label}: {key} is {getattr(self, key)}, must be positive")
        for name, volume in zip(self.bodies, self.volume.ravel()):
            if not volume > 0.0:
                problems.append(f"{label}: volume of '{name}' is {volume}, must be positive")
        return problems

    def index(self, body: str | int) -> int:
        """Place of a body among `bodies`, given by name or index. Raises ModelError if there is none."""
        if body in self.bodies:
            return self.bodies.index(str(body))
        if isinstance(body, int) and not isinstance(body, bool) and 0 <= body < len(self.bodies):
            return body
        known = ", ".join(f"'{name}'" for name in self.bodies)
        raise ModelError(f"hydrodynamic database '{self.name}': there is no body {body!r}; it has {known}")

    def at(self, omega: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """A(w) and B(w), (d, d) each, at omega [rad/s]: cubic in between, B(0) = 0, A held below the lowest
        frequency (or taken to A(0) where it is known); A_inf and no damping above the highest."""
        from scipy.interpolate import CubicSpline

        if omega > self.omega[-1]:
            return self.added_mass_inf, np.zeros_like(self.added_mass_inf)
        damping = np.concatenate([np.zeros_like(self.radiation_damping[:1]), self.radiation_damping])
        B = CubicSpline(np.concatenate([[0.0], self.omega]), damping)(omega)
        if self.added_mass_zero is not None:
            mass = np.concatenate([self.added_mass_zero[None], self.added_mass])
            return CubicSpline(np.concatenate([[0.0], self.omega]), mass)(omega), B
        return CubicSpline(self.omega, self.added_mass)(max(omega, self.omega[0])), B

    @classmethod
    def read(cls, path: str | Path) -> HydroDatabase:
        """Database in the netCDF file `path`, whatever time sign its author used.

        Phases written for e^{-i w t} are conjugated (time factors of opposite sign describe the same force by
        conjugate amplitudes). Raises ModelError if the file cannot be read, lacks something, or
        refers its phases to anything but the world origin.
        """
        import netCDF4

        label = f"hydrodynamic database '{path}'"
        try:
            with netCDF4.Dataset(path) as file:
                file.set_auto_mask(False)
                return cls(**_contents(file, label))
        except OSError as error:
            raise ModelError(f"{label}: cannot be read as netCDF: {error.strerror or error}") from None

    def write(self, path: str | Path) -> None:
        """Write `path` (netCDF, coefficients in float32, compressed), time factor e^{+i w t}.

        Raises ModelError if the path cannot be written.
        """
        import netCDF4

        try:
            with netCDF4.Dataset(path, "w") as file:
                _fill(file, self)
        except OSError as error:
            raise ModelError(
                f"hydrodynamic database '{path}': cannot be written: {error.strerror or error}"
            ) from None


# --- the file -----------------------------------------------------------------------------------

_AXES = {  # variable -> dimensions, unit
    "added_mass": (("omega", "influenced_dof", "radiating_dof"), "kg, kg m, kg m2"),
    "radiation_damping": (("omega", "influenced_dof", "radiating_dof"), "N s/m, N s, N m s"),
    "added_mass_inf": (("influenced_dof", "radiating_dof"), "kg, kg m, kg m2"),
    "added_mass_zero": (("influenced_dof", "radiating_dof"), "kg, kg m, kg m2"),
    "excitation": (("complex", "omega", "wave_direction", "influenced_dof"), "N/m, N"),
    "froude_krylov": (("complex", "omega", "wave_direction", "influenced_dof"), "N/m, N"),
    "mean_drift": (("omega", "wave_direction", "influenced_dof"), "N/m2, N/m"),
    "hydrostatic_stiffness": (("influenced_dof", "radiating_dof"), "N/m, N, N m"),
    "volume": (("body",), "m3"),
    "centre_of_buoyancy": (("body", "xyz"), "m"),
    "reference_point": (("body", "xyz"), "m"),
    "hull_vertices": (("hull_vertex", "xyz"), "m"),
    "hull_faces": (("hull_face", "corner"), "1"),
    "hull_body": (("hull_face",), "1"),
}
_EXACT = (
    "hydrostatic_stiffness",
    "volume",
    "centre_of_buoyancy",
    "reference_point",
    "hull_vertices",
)  # float64
_OPTIONAL = ("added_mass_zero", "froude_krylov", "mean_drift", "hull_vertices", "hull_faces", "hull_body")
_OWN_ATTRIBUTES = ("database", "time_sign", "phase_origin", "water_depth", "rho", "g", "long_name")


def _fill(file: Any, db: HydroDatabase) -> None:
    N = len(db.bodies)
    dofs = DOF_NAMES if N == 1 else [f"{body}__{dof}" for body in db.bodies for dof in DOF_NAMES]
    sizes = {"omega": db.omega.size, "wave_direction": db.headings.size, "complex": 2, "body": N, "xyz": 3}
    sizes |= {"influenced_dof": 6 * N, "radiating_dof": 6 * N}
    if db.hull_vertices is not None and db.hull_faces is not None:
        sizes |= {"hull_vertex": len(db.hull_vertices), "hull_face": len(db.hull_faces), "corner": 4}
    for name, size in sizes.items():
        file.createDimension(name, size)
    labels = {
        "complex": ("re", "im"),
        "influenced_dof": dofs,
        "radiating_dof": dofs,
        "body": db.bodies,
    }
    for name, words in labels.items():
        file.createVariable(name, str, (name,))[:] = np.array(words, dtype=object)
    for name, values, unit in (("omega", db.omega, "rad/s"), ("wave_direction", db.headings, "rad")):
        file.createVariable(name, "f8", (name,))[:] = values
        file[name].units = unit
    for name, (axes, unit) in _AXES.items():
        value = getattr(db, name)
        if value is None or not set(axes) <= set(sizes):
            continue
        kind = "f8" if name in _EXACT else "i4" if name in ("hull_faces", "hull_body") else "f4"
        if "complex" in axes:
            value = np.stack([value.real, value.imag])
        variable = file.createVariable(name, kind, axes, zlib=True, complevel=9, shuffle=True)
        variable[:] = np.reshape(value, [sizes[axis] for axis in axes])
        variable.units = unit
        variable.long_name = name.replace("_", " ")
    for name, value in db.source.items():
        file.setncattr(name, value)
    file.database = db.name
    file.time_sign, file.phase_origin = _PLUS, _PHASE_ORIGIN
    file.water_depth, file.rho, file.g = db.depth, db.density, db.gravity


def _contents(file: Any, label: str) -> dict[str, Any]:
    """Arguments of HydroDatabase from an open file; dimensions are recognised by name, in any order."""
    needed = {"omega", "wave_direction", *_AXES} - set(_OPTIONAL)
    problems = [f"{label}: variable '{name}' is missing" for name in sorted(needed - set(file.variables))]
    attributes = {name: file.getncattr(name) for name in file.ncattrs()}
    wanted = ("time_sign", "phase_origin", "water_depth", "rho", "g")
    problems += [f"{label}: attribute '{name}' is missing" for name in wanted if name not in attributes]
    if problems:
        raise ModelError(problems)
    if attributes["time_sign"] not in (_PLUS, _MINUS):
        problems.append(f"{label}: time_sign is '{attributes['time_sign']}', must be '{_PLUS}' or '{_MINUS}'")
    if attributes["phase_origin"] != _PHASE_ORIGIN:
        problems.append(f"{label}: phase_origin is '{attributes['phase_origin']}', must be '{_PHASE_ORIGIN}'")
    values: dict[str, Any] = {}
    for name, (axes, _) in _AXES.items():
        if name not in file.variables:
            continue
        variable = file[name]
        if sorted(variable.dimensions) != sorted(axes):
            problems.append(f"{label}: '{name}' has dimensions {variable.dimensions}, must be {axes}")
            continue
        values[name] = np.transpose(variable[:], [variable.dimensions.index(axis) for axis in axes])
    if problems:
        raise ModelError(problems)
    for name in ("excitation", "froude_krylov"):
        if name in values:
            re, im = values[name].astype(np.float64)
            values[name] = re + 1j * im if attributes["time_sign"] == _PLUS else re - 1j * im
    bodies = tuple(str(item) for item in file["body"][:]) if "body" in file.variables else ()
    numbers = {"depth": "water_depth", "density": "rho", "gravity": "g"}
    source = {key: value for key, value in attributes.items() if key not in _OWN_ATTRIBUTES}
    return {
        **values,
        **{key: float(attributes[name]) for key, name in numbers.items()},
        "name": str(attributes.get("database") or (bodies[0] if bodies else Path(file.filepath()).name)),
        "bodies": bodies,
        "omega": file["omega"][:],
        "headings": file["wave_direction"][:],
        "source": {
            key: value.item() if isinstance(value, np.generic) else value for key, value in source.items()
        },
    }


# --- does it make sense? ------------------------------------------------------------------------


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
    - heave excitation at the lowest frequency against rho g A_wp - w^2 (rho V + A33): a small body
      in long waves feels the moving water (Newman, Marine Hydrodynamics, 1977),
    - frequencies and headings cover what time-domain forces need.
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
    findings += [_long_wave_heave(db, k) for k in range(len(db.bodies))]
    findings.append(_highest_frequency(db))
    findings.append(_frequency_step(db))
    findings.append(_heading_step(db))
    return tuple(findings)


def require_match(
    db: HydroDatabase,
    *,
    depth: float,
    reference_point: tuple[float, float, float] | NDArray[np.float64],
    density: float,
    gravity: float,
    body: int = 0,
) -> None:
    """Refuse a database made for another site, or about another point of its body number `body`.

    Allowed: depth, density and gravity within 1 %, 0.5 % and 0.1 %, the reference point (m, world frame,
    drawing position) within 0.01 m; a database of deep water where `deep_enough`. Raises ModelError with all that does
    not fit.
    """
    problems = []
    for label, got, want, allowed, unit in (
        ("water depth", db.depth, depth, 0.01, "m"),
        ("water density", db.density, density, 0.005, "kg/m3"),
        ("gravity", db.gravity, gravity, 0.001, "m/s2"),
    ):
        if label == "water depth" and got == np.inf and deep_enough(db, want):
            continue
        if got != want and not abs(got - want) <= allowed * want:
            problems.append(
                f"hydrodynamic database '{db.name}': {label} is {got:g} {unit}, the model "
                f"has {want:g} {unit} (allowed difference {100 * allowed:g} %); take one computed for it"
            )
    point = np.asarray(reference_point, dtype=np.float64)
    if np.linalg.norm(db.reference_point[body] - point) > 0.01:
        of = f" of '{db.bodies[body]}'" if len(db.bodies) > 1 else ""
        problems.append(
            f"hydrodynamic database '{db.name}': reference point{of} is {_point(db.reference_point[body])} m, "
            f"the body's is {_point(point)} m (allowed difference 0.01 m); move the body's or recompute"
        )
    if problems:
        raise ModelError(problems)


def deep_enough(db: HydroDatabase, depth: float) -> bool:
    """Whether water of `depth` [m] is deep for waves of the frequencies at which the bodies radiate most: tanh(k h) is
    above 0.99 at the lowest of the peaks of the diagonal of B, k = w^2/g."""
    share = np.abs(np.diagonal(db.radiation_damping, axis1=1, axis2=2))
    k = db.omega[share.argmax(axis=0)[share.max(axis=0) > 0.01 * _damping_scale(db) ** 2].min()] ** 2 / db.gravity
    return bool(np.tanh(k * depth) > 0.99)


def added_mass_from_damping(omega: NDArray[np.float64], damping: NDArray[np.float64]) -> NDArray[np.float64]:
    """A(w) - A_inf, (n, ...), that belongs to damping B (n, ...) at omega (n,) rad/s (Kramers-Kronig).

    2/pi P int_0^w_max B(s) / (s^2 - w^2) ds with B linear between the frequencies and zero at zero, each
    piece integrated exactly. What B has beyond w_max is missing. Equation: Ogilvie (1964), Recent progress
    toward the understanding and prediction of ship motions.
    """
    s = np.concatenate([[0.0], omega])
    value = np.concatenate([np.zeros_like(damping[:1]), damping]).reshape(s.size, -1)
    slope = np.diff(value, axis=0) / np.diff(s)[:, None]
    offset = value[:-1] - slope * s[:-1, None]
    distance = np.abs(s - omega[:, None])
    # at s = w the logarithms of the two neighbouring pieces cancel: principal value
    minus = np.log(np.where(distance == 0.0, 1.0, distance))
    plus = np.log(s + omega[:, None])
    integral = np.diff(minus - plus, axis=1) @ offset / (2.0 * omega[:, None])
    integral += 0.5 * np.diff(minus + plus, axis=1) @ slope
    return (2.0 / np.pi * integral).reshape(damping.shape)


def _not_finite(value: Any) -> bool:
    return isinstance(value, np.ndarray) and not bool(np.all(np.isfinite(value)))


def _point(p: NDArray[np.float64]) -> str:
    return f"({p[0]:g}, {p[1]:g}, {p[2]:g})"


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
    floor = 1e-4 * _mass_scale(db) ** 2 * db.omega[-1]
    return np.sqrt(np.maximum(_diagonal_max(db.radiation_damping), floor))


def _dof(db: HydroDatabase, i: int) -> str:
    return (f"{db.bodies[i // 6]} " if len(db.bodies) > 1 else "") + DOF_NAMES[i % 6].lower()


def _pair(db: HydroDatabase, i: int, j: int) -> str:
    return f"{_dof(db, i)}-{_dof(db, j)}"


def _bodies(count: int) -> str:
    return "1 body" if count == 1 else f"{count} bodies"


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
        "a coarse mesh, rows and columns mixed up, or moments about another point"
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
    return _graded("added mass at infinite frequency", size, 0.02, 0.1, text, text + hint)


def _long_wave_heave(db: HydroDatabase, body: int) -> Finding:
    label = "long-wave heave excitation" + (f" of {db.bodies[body]}" if len(db.bodies) > 1 else "")
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
    error = np.abs(db.excitation[0, :, heave] - (stiffness - inertia)) / stiffness
    k = int(np.argmax(error))
    got, size = db.excitation[0, k, heave], float(error[k])
    text = (
        f"at {w:.3g} rad/s, heading {np.degrees(db.headings[k]):.0f} deg, X3 is {got.real:.4g} "
        f"{got.imag:+.2g}i N/m, the waterplane says {stiffness - inertia:.4g}"
    )
    hint = "; check the scaling by rho g, the time sign, and where phases are measured from"
    return _graded(label, size, allowed, 2.0 * allowed, text, text + hint)


def _highest_frequency(db: HydroDatabase) -> Finding:
    share = _diagonal_max(db.radiation_damping[-1:]) / _damping_scale(db) ** 2
    i = int(np.argmax(share))
    size = float(share[i])
    text = (
        f"at the highest frequency, {db.omega[-1]:.3g} rad/s, {_dof(db, i)} damping is down to "
        f"{100 * size:.2g} % of its peak"
    )
    hint = "; the radiation memory will ring: compute higher frequencies"
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
    text = f"headings at most {size:.3g} deg apart around the circle"
    hint = "; between headings further apart than 10 deg excitation cannot be interpolated"
    return _graded("heading step", size, 10.01, 360.0, text, text + hint)
