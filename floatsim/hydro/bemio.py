"""BEMIO's HDF5 files, the hydrodynamic input of WEC-Sim, as a `HydroDatabase`.

BEMIO (WEC-Sim, source/functions/BEMIO) stores WAMIT's normalisation with ULEN = 1: stiffness C/(rho g), added mass
A/rho, damping B/(rho w), excitation X/(rho g), mean drift F/(rho g). Its time factor is e^{+i w t}, phases refer to
the world origin, headings are in degrees and those towards which waves travel: nothing changes sign. Every body has a
group with its six rows of the matrices of all bodies, frequencies last. Moments are about the centre of gravity, as
WEC-Sim demands, and the stiffness contains a weight there. Depth is a number or the word "infinite".
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from floatsim.errors import ModelError
from floatsim.hydro.conventions import Array, body_names, ordered_headings, per_body, without_weight
from floatsim.hydro.database import HydroDatabase

_DRIFT = ("control_surface", "momentum_conservation", "pressure_integration")  # the first there is, is taken


def read_bemio(
    path: str | Path, *, reference_point: ArrayLike | None = None, bodies: Sequence[str] = ()
) -> HydroDatabase:
    """Database from the HDF5 file `path`.

    reference_point  the point of the moments in the world frame, m, of N bodies N times; default the centre of gravity
    bodies           names; default those of the file

    Raises ModelError for a file that cannot be read, lacks something, is scaled, or has flexible modes.
    """
    import netCDF4

    label = f"BEMIO file '{path}'"
    try:
        with netCDF4.Dataset(path) as file:  # netCDF-4 is HDF5
            file.set_auto_mask(False)
            return _database(file, label, Path(path).name, reference_point, bodies)
    except (OSError, RuntimeError) as error:  # the second where the file is torn inside
        raise ModelError(f"{label}: cannot be read as HDF5: {getattr(error, 'strerror', None) or error}") from None


def _database(file: Any, label: str, name: str, reference_point: Any, names: Sequence[str]) -> HydroDatabase:
    N = sum(1 for group in file.groups if group.startswith("body"))
    if "simulation_parameters" not in file.groups or N == 0:
        raise ModelError(f"{label}: has no groups simulation_parameters and body1; is it a file of BEMIO?")
    d = 6 * N

    def read(place: str, *shape: int) -> Array:
        try:
            values = np.asarray(file[place][...], dtype=np.float64)
        except (IndexError, KeyError):
            raise ModelError(f"{label}: does not hold '{place}'") from None
        if values.size != np.prod(shape):
            raise ModelError(f"{label}: '{place}' has shape {values.shape}, must be {shape}; six motions per body only")
        return values.reshape(shape)

    def rows(place: str, *shape: int) -> Array:
        """(d, ...): the six rows of every body."""
        return np.concatenate([read(f"body{k + 1}/{place}", 6, *shape) for k in range(N)])

    water = "simulation_parameters/"
    if np.any(read(water + "scaled", 1)):
        raise ModelError(f"{label}: is scaled already; write it without (scaled = 0)")
    rho, g = read(water + "rho", 1)[0], read(water + "g", 1)[0]
    n = file[water + "w"].size
    w = read(water + "w", n)
    order = np.argsort(w)
    headings, take = ordered_headings(np.radians(read(water + "wave_dir", file[water + "wave_dir"].size)))
    m = file[water + "wave_dir"].size

    def force(part: str) -> Any:
        X = rows(f"hydro_coeffs/{part}/re", m, n) + 1j * rows(f"hydro_coeffs/{part}/im", m, n)
        return rho * g * X.transpose(2, 1, 0)[order][:, take]

    def matrices(place: str) -> Array:
        return rho * rows(f"hydro_coeffs/{place}/all", d, n).transpose(2, 0, 1)[order]

    V = np.array([read(f"body{k + 1}/properties/disp_vol", 1)[0] for k in range(N)])
    B, G = (np.array([read(f"body{k + 1}/properties/{what}", 3) for k in range(N)]) for what in ("cb", "cg"))
    P = G if reference_point is None else per_body(label, "reference_point", reference_point, N, 3)
    stiffness = np.zeros((d, d))
    for k in range(N):
        block = slice(6 * k, 6 * k + 6)
        stiffness[block, block] = rho * g * read(f"body{k + 1}/hydro_coeffs/linear_restoring_stiffness", 6, 6)
    part = "excitation/froude-krylov"
    froude_krylov = force(part) if _there(file, f"body1/hydro_coeffs/{part}/re") else None
    method = next((item for item in _DRIFT if _there(file, f"body1/hydro_coeffs/mean_drift/{item}/val")), None)
    drift = None
    if method is not None:
        drift = rho * g * rows(f"hydro_coeffs/mean_drift/{method}/val", m, n).transpose(2, 1, 0)[order][:, take]
    own = [str(file[f"body{k + 1}/properties/name"][...]).strip() for k in range(N)]
    own = own if len(set(own)) == N else []
    return HydroDatabase(
        name=name,
        bodies=body_names(label, names or own, N, name),
        omega=w[order],
        added_mass=matrices("added_mass"),
        radiation_damping=matrices("radiation_damping") * w[order, None, None],
        added_mass_inf=rho * rows("hydro_coeffs/added_mass/inf_freq", d),
        headings=headings,
        excitation=force("excitation"),
        froude_krylov=froude_krylov if froude_krylov is None or np.all(np.isfinite(froude_krylov)) else None,
        mean_drift=drift if drift is None or np.all(np.isfinite(drift)) else None,
        hydrostatic_stiffness=without_weight(stiffness, rho * g * V, G - P),
        volume=V,
        centre_of_buoyancy=B,
        reference_point=P,
        depth=_depth(file[water + "water_depth"][...]),
        density=rho,
        gravity=g,
        source={"solver": f"{str(file['bem_data/code'][...]).strip()}, by BEMIO" if "bem_data" in file.groups
                else "BEMIO"},
    )  # fmt: skip


def _there(file: Any, place: str) -> bool:
    try:
        file[place]
    except (IndexError, KeyError):
        return False
    return True


def _depth(value: Any) -> float:
    if isinstance(value, str):
        return np.inf if value.strip().lower().startswith("inf") else float(value)
    return float(np.ravel(value)[0])
