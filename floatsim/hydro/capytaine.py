"""Datasets that Capytaine writes (netCDF, complex numbers as real and imaginary part) as a `HydroDatabase`.

Capytaine (user manual, "Conventions"; 2 and 3) has the time factor e^{-i w t}: amplitudes are conjugated. Phases
refer to the world origin, headings are those towards which waves travel, in rad; everything is in SI units. Motions
are called Surge ... Yaw, BODY__Surge and so on of several bodies; the frequency axis may be omega, period or another,
with omega in the file, and may hold infinity and zero. Moments are about the centre of rotation.
`hydrostatic_stiffness` is about that centre and contains a weight at the centre of mass; the weight is that of the
inertia matrix, or of the displaced water where no mass was set. Since version 3 the file holds volume and centres.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from floatsim.errors import ModelError
from floatsim.hydro.conventions import (
    ESTIMATED,
    Array,
    body_names,
    infinite_added_mass,
    ordered_headings,
    per_body,
    plain,
    without_weight,
)
from floatsim.hydro.database import DOF_NAMES, HydroDatabase
from floatsim.hydro.nemoh import read_hydrostatics

_POINTS = ("center_of_buoyancy", "center_of_mass", "rotation_center")


def read_capytaine(
    path: str | Path,
    *,
    volume: float | Sequence[float] | None = None,
    centre_of_buoyancy: ArrayLike | None = None,
    centre_of_gravity: ArrayLike | None = None,
    reference_point: ArrayLike | None = None,
    hydrostatics: str | Path | None = None,
    bodies: Sequence[str] = (),
    estimate_added_mass_inf: bool = False,
    drop_incomplete: bool = False,
) -> HydroDatabase:
    """Database from the netCDF file `path`. Of N bodies N times, where the file does not hold it (files of version 2):

    volume              m3, displaced
    centre_of_buoyancy  m, world frame
    centre_of_gravity   the centre of mass that Capytaine was given, m, world frame
    reference_point     its centre of rotation, m, world frame
    hydrostatics        folder with Hydrostatics.dat and KH.dat (of several bodies _0.dat, _1.dat ...), which then give
                        volume, centres and stiffness
    bodies              names; default those of the file
    estimate_added_mass_inf  take what A(w) and B(w) imply where omega = inf was not computed
    drop_incomplete          leave out frequencies at which added mass or excitation failed

    Raises ModelError for a file that cannot be read, lacks something or has other motions than six per body.
    """
    import netCDF4

    label = f"Capytaine file '{path}'"
    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            data = _Dataset(file, label, drop_incomplete)
    except (OSError, RuntimeError) as error:  # the second where the file is torn inside
        raise ModelError(f"{label}: cannot be read as netCDF: {getattr(error, 'strerror', None) or error}") from None
    N, one = len(data.bodies), data.numbers
    statics = None if hydrostatics is None else read_hydrostatics(hydrostatics, N)
    have: dict[str, Any] = {
        "volume": data.volume if statics is None else statics.volume,
        "centre_of_buoyancy": data.points["center_of_buoyancy"] if statics is None else statics.centre_of_buoyancy,
        "centre_of_gravity": data.points["center_of_mass"] if statics is None else statics.centre_of_gravity,
        "reference_point": data.points["rotation_center"],
    }
    given = {"volume": volume, "centre_of_buoyancy": centre_of_buoyancy, "centre_of_gravity": centre_of_gravity,
             "reference_point": reference_point}  # fmt: skip
    have |= {name: value for name, value in given.items() if value is not None}
    missing = [name for name, value in have.items() if value is None]
    if missing:
        raise ModelError(
            f"{label}: does not hold {', '.join(missing)}; give {' and '.join(f'{name}=...' for name in missing)}"
            + ("" if missing == ["reference_point"] else ", or hydrostatics= the folder with its Hydrostatics.dat")
        )
    V = per_body(label, "volume", have["volume"], N)
    B, G, P = (per_body(label, name, have[name], N, 3) for name in list(have)[1:])
    if statics is not None:
        stiffness = statics.about(P, one["rho"] * one["g"])
    elif data.stiffness is None:
        raise ModelError(f"{label}: does not hold hydrostatic_stiffness; give hydrostatics= the folder with KH.dat")
    else:
        weight = one["g"] * (one["rho"] * V if data.mass is None else data.mass)
        stiffness = without_weight(data.stiffness, weight, G - P)
    source: dict[str, Any] = {"solver": "Capytaine", **data.source}
    finite, omega = data.finite, data.omega[data.finite]
    mass, damping = data.added_mass[finite], data.radiation_damping[finite]
    mass_inf, mass_zero = data.at(np.inf), data.at(0.0)
    if mass_inf is None:
        mass_inf = infinite_added_mass(label, omega, mass, damping, estimate_added_mass_inf)
        source["added_mass_inf"] = ESTIMATED
    headings, take = ordered_headings(data.headings)
    return HydroDatabase(
        name=Path(path).name,
        bodies=body_names(label, bodies or data.names, N, Path(path).name),
        omega=omega,
        added_mass=mass,
        radiation_damping=damping,
        added_mass_inf=mass_inf,
        added_mass_zero=mass_zero,
        headings=headings,
        excitation=data.excitation[finite][:, take].conj(),
        froude_krylov=None if data.froude_krylov is None else data.froude_krylov[finite][:, take].conj(),
        hydrostatic_stiffness=stiffness,
        volume=V,
        centre_of_buoyancy=B,
        reference_point=P,
        depth=one["water_depth"],
        density=one["rho"],
        gravity=one["g"],
        source=source,
    )


class _Dataset:
    """The file's arrays, frequencies first and increasing, motions body by body; still e^{-i w t}."""

    def __init__(self, file: Any, label: str, drop_incomplete: bool) -> None:
        self.file, self.label = file, label
        needed = ("omega", "wave_direction", "influenced_dof", "radiating_dof", "added_mass", "radiation_damping")
        missing = [name for name in (*needed, "rho", "g", "water_depth") if name not in file.variables]
        if missing:
            raise ModelError(f"{label}: does not hold {', '.join(missing)}; is it a dataset of Capytaine?")
        self.numbers = {name: self._number(name) for name in ("rho", "g", "water_depth")}
        if "forward_speed" in file.variables and self._number("forward_speed") != 0.0:
            raise ModelError(f"{label}: was computed with forward speed, which cannot be used")
        self.axis = file["omega"].dimensions[0] if file["omega"].dimensions else "omega"
        omega = np.atleast_1d(np.asarray(file["omega"][:], dtype=np.float64))
        self.rows = np.argsort(omega)
        self.omega = omega[self.rows]
        self.finite = np.isfinite(self.omega) & (self.omega > 0.0)
        self.headings = np.atleast_1d(np.asarray(file["wave_direction"][:], dtype=np.float64))
        self.bodies, self.force_order = self._motions("influenced_dof")
        _, self.motion_order = self._motions("radiating_dof", self.bodies)
        pair = ("influenced_dof", "radiating_dof")
        self.added_mass = self._array("added_mass", self.axis, *pair)
        self.radiation_damping = self._array("radiation_damping", self.axis, *pair)
        self.froude_krylov = self._complex("Froude_Krylov_force")
        total, diffraction = self._complex("excitation_force"), self._complex("diffraction_force")
        if total is None and (self.froude_krylov is None or diffraction is None):
            raise ModelError(f"{label}: does not hold diffraction_force and Froude_Krylov_force; solve for waves too")
        self.excitation = self.froude_krylov + diffraction if total is None else total
        solved = np.isfinite(self.excitation).all(axis=(1, 2)) & np.isfinite(self.added_mass).all(axis=(1, 2))
        holes = self.omega[self.finite & ~solved]
        if holes.size and not drop_incomplete:
            raise ModelError(
                f"{label}: added mass or excitation is missing at {holes.size} frequencies, the first "
                f"{holes[0]:.4g} rad/s; solve for them, or leave them out with drop_incomplete=True"
            )
        self.finite &= solved
        here = file.variables
        self.stiffness = self._array("hydrostatic_stiffness", *pair) if "hydrostatic_stiffness" in here else None
        self.mass = np.diagonal(self._array("inertia_matrix", *pair))[2::6] if "inertia_matrix" in here else None
        self.points = {name: self._points(name) for name in _POINTS}
        self.volume = None
        if "disp_mass" in file.variables:
            self.volume = np.asarray(file["disp_mass"][:], dtype=np.float64).ravel() / self.numbers["rho"]
        self.names = self.bodies if self.bodies != ("",) else ()
        for name in ("body", "body_name"):
            if not self.names and name in file.variables and np.size(file[name][...]) == 1:
                self.names = (_text(np.ravel(file[name][...])[0]),)
        version = getattr(file, "capytaine_version", None)
        self.source = {} if version is None else {"capytaine_version": plain(version)}

    def at(self, omega: float) -> Array | None:
        """Added mass at infinite or zero frequency, if it was computed."""
        place = np.flatnonzero(self.omega == omega)
        return None if place.size == 0 else self.added_mass[place[0]]

    def _number(self, name: str) -> float:
        value = np.asarray(self.file[name][...], dtype=np.float64)
        if value.size != 1:
            raise ModelError(f"{self.label}: holds {value.size} values of {name}; select one of them first")
        return float(value.ravel()[0])

    def _motions(self, axis: str, bodies: tuple[str, ...] = ()) -> tuple[tuple[str, ...], list[int]]:
        """Bodies, in their order along `axis` unless given, and the places of their six motions along it."""
        labels = [_text(word) for word in self.file[axis][:]]
        split = [label.rpartition("__") for label in labels]
        bodies = bodies or tuple(dict.fromkeys(body for body, _, _ in split))
        place = {(body, dof.lower()): k for k, (body, _, dof) in enumerate(split)}
        wanted = [(body, dof.lower()) for body in bodies for dof in DOF_NAMES]
        lacking = [f"{body}__{dof.title()}".lstrip("_") for body, dof in wanted if (body, dof) not in place]
        if lacking or len(labels) != len(wanted):
            unknown = [label for label, (body, _, dof) in zip(labels, split) if (body, dof.lower()) not in wanted]
            pairs = (("missing", lacking), ("unknown", unknown))
            wrong = [f"{what}: {', '.join(which)}" for what, which in pairs if which]
            raise ModelError(
                f"{self.label}: {axis} must be Surge, Sway, Heave, Roll, Pitch, Yaw of every body; {'; '.join(wrong)}"
            )
        return bodies, [place[key] for key in wanted]

    def _array(self, name: str, *axes: str) -> Array:
        """Variable with its axes in the order asked for, frequencies increasing, motions body by body."""
        variable = self.file[name]
        dims = [dim for dim, size in zip(variable.dimensions, variable.shape) if size > 1 or dim in axes]
        if sorted(dims) != sorted(axes):
            raise ModelError(f"{self.label}: '{name}' has dimensions {variable.dimensions}, must be {axes}")
        values = np.asarray(variable[:]).reshape([variable.shape[variable.dimensions.index(dim)] for dim in dims])
        values = values.transpose([dims.index(axis) for axis in axes])
        order: dict[str, Any] = {"influenced_dof": self.force_order, "radiating_dof": self.motion_order}
        order[self.axis] = self.rows
        for k, axis in enumerate(axes):
            if axis in order:
                values = values.take(order[axis], axis=k)
        return values

    def _complex(self, name: str) -> Any:
        if name not in self.file.variables:
            return None
        parts = self._array(name, "complex", self.axis, "wave_direction", "influenced_dof")
        labels = [_text(word) for word in self.file["complex"][:]] if "complex" in self.file.variables else ["re", "im"]
        return parts[labels.index("re")] + 1j * parts[labels.index("im")]

    def _points(self, name: str) -> Array | None:
        if name not in self.file.variables:
            return None
        values = np.asarray(self.file[name][:], dtype=np.float64).reshape(-1, 3)
        return values if np.all(np.isfinite(values)) else None


def _text(word: Any) -> str:
    """A label, whether the file has it as a string or as characters."""
    if isinstance(word, np.ndarray) and word.ndim:
        word = b"".join(word.tolist()) if word.dtype.kind == "S" else "".join(word.tolist())
    return (word.decode() if isinstance(word, bytes) else str(word)).strip("\x00 ")
