"""`read_hydro`: a hydrodynamic database from whatever the coefficients were computed with."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

from floatsim.errors import ModelError, nearest
from floatsim.hydro.bemio import read_bemio
from floatsim.hydro.capytaine import read_capytaine
from floatsim.hydro.conventions import in_folder
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.hams import read_hams
from floatsim.hydro.nemoh import read_nemoh
from floatsim.hydro.wamit import read_wamit

_NETCDF = (b"CDF\x01", b"CDF\x02", b"CDF\x05")
_HDF5 = b"\x89HDF"
_POSITIVE = {"depth", "density", "gravity", "length"}
_YES_OR_NO = {"estimate_added_mass_inf", "drop_incomplete", "conjugate"}
_WAMIT = (".1", ".3", ".hst", ".3fk", ".3sc", ".8", ".9")


def _read_own(path: str | Path) -> HydroDatabase:
    return HydroDatabase.read(path)


Reader = tuple[str, Callable[..., HydroDatabase], str | Path]


def read_hydro(path: str | Path, **options: Any) -> HydroDatabase:
    """Database from `path`, whose format is recognised by what is there:

    a netCDF file          floatsim's own, or a dataset of Capytaine
    an HDF5 file           BEMIO's, for WEC-Sim
    a folder               of Nemoh (with Nemoh.cal) or of HAMS (with Input/ControlFile.in); either file will do too
    name.1, .3 or .hst     WAMIT's numeric output, also without the ending

    options: what the format does not contain, under the names that its reader has (`read_wamit` and so on).
    Raises ModelError for a format that is not recognised, and for options it lacks or does not take, by name.
    """
    name, reader, target = _recognise(Path(path))
    parameters = inspect.signature(reader).parameters
    known = [key for key, item in parameters.items() if item.kind is inspect.Parameter.KEYWORD_ONLY]
    problems = [
        f"'{path}' is {name}, whose reader has no option '{key}'"
        + (nearest(key, known) if known else "; the file holds everything")
        for key in options
        if key not in known
    ]
    missing = [key for key in known if parameters[key].default is inspect.Parameter.empty and key not in options]
    if missing:
        problems.append(
            f"'{path}' is {name}, which does not contain {', '.join(missing)}: give "
            + ", ".join(f"{key}=..." for key in missing)
        )
    for key in _POSITIVE & set(options):
        try:
            options[key] = float(options[key])  # inf too, which is a word on the command line
        except (TypeError, ValueError):
            options[key] = 0.0
        if not options[key] > 0.0:
            problems.append(f"'{path}': {key} must be a positive number")
    for key in _YES_OR_NO & set(options):
        if not isinstance(options[key], bool):
            problems.append(f"'{path}': {key} must be True or False, got {options[key]!r}")
    if "hydrostatics" in options and not isinstance(options["hydrostatics"], (str, Path)):
        problems.append(f"'{path}': hydrostatics must be a folder, got {options['hydrostatics']!r}")
    if problems:
        raise ModelError(problems)
    return reader(target, **options)


def _recognise(path: Path) -> Reader:
    if path.is_dir():
        return _folder(path, path)
    if path.name.lower() in ("nemoh.cal", "controlfile.in"):
        return _folder(path.parent, path)
    for ending in _WAMIT:
        for last in (ending, f"{ending}.gz"):
            if path.name.endswith(last) and path.is_file():
                return "WAMIT's numeric output", read_wamit, path.with_name(path.name.removesuffix(last))
    if not path.exists():
        if any(Path(f"{path}{last}").is_file() for last in (".1", ".1.gz")):
            return "WAMIT's numeric output", read_wamit, path
        raise ModelError(f"'{path}': there is no such file or folder")
    try:
        with path.open("rb") as file:
            start = file.read(4)
    except OSError as error:
        raise ModelError(f"'{path}': cannot be read: {error.strerror or error}") from None
    if start in (*_NETCDF, _HDF5):
        return _netcdf(path)
    hint = "; unpack it first" if start[:2] == b"\x1f\x8b" else ""
    raise ModelError(
        f"'{path}': not a format that can be read{hint}. Known are netCDF of floatsim or Capytaine, HDF5 of BEMIO, "
        "folders of Nemoh or HAMS, and WAMIT's .1 .3 .hst"
    )


def _folder(folder: Path, path: Path) -> Reader:
    if in_folder(folder, "Nemoh.cal"):
        return "a folder of Nemoh", read_nemoh, path
    if in_folder(folder, "ControlFile.in") or in_folder(in_folder(folder, "Input") or folder, "ControlFile.in"):
        return "a folder of HAMS", read_hams, path
    raise ModelError(f"'{path}': a folder with neither Nemoh.cal nor Input/ControlFile.in (of HAMS) in it")


def _netcdf(path: Path) -> Reader:
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            if "time_sign" in file.ncattrs() or {"excitation", "added_mass_inf"} <= set(file.variables):
                return "a database of floatsim", _read_own, path
            if "radiating_dof" in file.variables:
                return "a dataset of Capytaine", read_capytaine, path
            if "simulation_parameters" in file.groups:
                return "a file of BEMIO", read_bemio, path
    except OSError as error:
        raise ModelError(f"'{path}': cannot be read: {error.strerror or error}") from None
    raise ModelError(f"'{path}': netCDF or HDF5, but neither a database of floatsim, nor of Capytaine, nor of BEMIO")
