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
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

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
    the numbers make sense is the business of `check.check_database`.
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

    @property
    def static_attitude_deg(self) -> NDArray[np.float64] | None:
        """Roll, pitch and yaw (N, 3) of the bodies, reference points where `reference_point` says, in a database that
        was computed at their static position; None for one computed as drawn."""
        angles = self.source.get("static_attitude_deg")
        return None if angles is None else np.reshape(np.asarray(angles, dtype=np.float64), (len(self.bodies), 3))

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

    def scaled(self, length: float, density: float | None = None) -> HydroDatabase:
        """The same floaters built to another scale, by Froude's law: all lengths times `length` (1/70 for a model at
        1:70), times with its square root, in the same gravity and in water of `density` (kg/m3, default the same).

        Exact: potential flow without surface tension knows no other number. Raises ModelError for a length or a
        density that is not positive and finite.
        """
        rho = self.density if density is None else density
        for label, value in (("length", length), ("density", rho)):
            if not 0.0 < value < np.inf:
                raise ModelError(f"hydrodynamic database '{self.name}': scaled: {label} is {value}, must be positive")
        each = length ** np.tile([0.0, 0.0, 0.0, 1.0, 1.0, 1.0], len(self.bodies))  # a moment has a length more
        pair, mass, rate = np.outer(each, each), rho / self.density * length**3, length**-0.5
        factors = {
            "omega": rate, "added_mass": mass * pair, "added_mass_inf": mass * pair, "added_mass_zero": mass * pair,
            "radiation_damping": rate * mass * pair, "hydrostatic_stiffness": rate**2 * mass * pair,
            "excitation": rate**2 * mass * each, "froude_krylov": rate**2 * mass * each,
            "mean_drift": rate**4 * mass * each, "volume": length**3, "centre_of_buoyancy": length,
            "reference_point": length, "depth": length, "hull_vertices": length,
        }  # fmt: skip
        values = {key: factor * getattr(self, key) for key, factor in factors.items() if getattr(self, key) is not None}
        source = {**self.source, "froude_scale": float(self.source.get("froude_scale", 1.0)) * length}
        for key in {"static_position", "static_draught"} & set(source):  # m
            source[key] = (length * np.ravel(source[key])).tolist()
        return replace(self, **values, density=rho, source=source)

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


# --- beside it -----------------------------------------------------------------------------------


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
            + (" (computed where the body floats: draw it there, or let its hull find it: PotentialFlow(hull=...))"
               if db.static_attitude_deg is not None else "")
        )  # fmt: skip
    if problems:
        raise ModelError(problems)


def deep_enough(db: HydroDatabase, depth: float) -> bool:
    """Whether water of `depth` [m] is deep for waves of the frequencies at which the bodies radiate most: tanh(k h) is
    above 0.99 at the lowest peak of the damping of surge, sway and heave (those of at least 1 % of the largest),
    k = w^2/g."""
    own = np.abs(np.diagonal(db.radiation_damping, axis1=1, axis2=2))[:, np.arange(6 * len(db.bodies)) % 6 < 3]
    counts = own.max(axis=0) >= 0.01 * own.max()
    k = db.omega[own.argmax(axis=0)[counts].min()] ** 2 / db.gravity
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


def _point(p: NDArray[np.float64]) -> str:
    return f"({p[0]:g}, {p[1]:g}, {p[2]:g})"


def _bodies(count: int) -> str:
    return "1 body" if count == 1 else f"{count} bodies"
