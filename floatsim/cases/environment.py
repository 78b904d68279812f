"""A case becomes a model: the script is called with its parameters, and the case's waves, current and wind.

A script whose build() takes `waves`, `current` or `wind` is given the object (None where the case has none); otherwise
waves and current go into the sea of the model it returns. Wind cannot be put in from outside: the rotor must know.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from floatsim.cases.case import Case
from floatsim.errors import CaseError, ModelError, nearest
from floatsim.model import Model
from floatsim.sea import SPECTRA
from floatsim.sea.site import Current, CurrentTable, PowerLaw
from floatsim.sea.waves import CombinedWaves, IrregularWaves, RegularWave
from floatsim.study.script import Script

SPECTRUM = {re.sub(r"(?<=.)(?=[A-Z])", "_", cls.__name__).lower(): cls for cls in SPECTRA}  # jonswap: Jonswap ...
_IRREGULAR = ("seed", "heading_deg", "spreading", "components", "duration", "omega_max")
_REGULAR = ("height", "period", "heading_deg", "phase_deg")
_CURRENT = ("speed", "heading_deg", "exponent", "depths", "factors", "turns_deg", "speeds", "headings_deg")
_FIELDS = {name: None for cls in SPECTRA for name in cls.model_fields}
KEYS = {"waves": ("kind", "spectrum", "combined", *_FIELDS, *_IRREGULAR, *_REGULAR), "current": _CURRENT}

Values = Mapping[str, Any]


def waves_of(values: Values, total: float) -> Any:
    """Waves from the values of a case: kind irregular (default), regular, none, or `combined`, a list of such.

    total [s]: simulated time, within which irregular waves must not repeat. Raises CaseError for unknown keys and
    ModelError for values that cannot be.
    """
    if not isinstance(values, Mapping):
        raise CaseError(f"waves: got {values!r}; must be keys with values")
    if "combined" in values:
        _known("waves", values, ("combined",))
        if not isinstance(values["combined"], list):
            raise CaseError(f"waves: combined: got {values['combined']!r}; must be a list of waves")
        return CombinedWaves(waves=tuple(waves_of(item, total) for item in values["combined"]))
    own = {key: y for key, y in values.items() if key != "kind"}
    kind = values.get("kind", "irregular")
    if kind == "none":
        return None
    if kind == "regular":
        _known("waves", own, _REGULAR)
        return RegularWave(**own)
    if kind != "irregular":
        raise CaseError(f"waves: kind: got {kind!r}; must be irregular, regular or none")
    name = str(own.pop("spectrum", "jonswap"))
    if name not in SPECTRUM:
        raise CaseError(f"waves: there is no spectrum '{name}'{nearest(name, SPECTRUM)}")
    fields = tuple(SPECTRUM[name].model_fields)
    _known("waves", own, ("spectrum", *fields, *_IRREGULAR))
    rest = {key: y for key, y in own.items() if key in _IRREGULAR}
    spectrum = SPECTRUM[name](**{key: y for key, y in own.items() if key in fields})
    return IrregularWaves(spectrum=spectrum, **{"duration": total, **rest})


def current_of(values: Values) -> Current:
    """Current from the values of a case: speed and heading_deg, with `exponent` of a power law or rows depths, factors
    and turns_deg; or measured rows depths, speeds and headings_deg. Raises as `waves_of`."""
    _known("current", values, _CURRENT)
    own = dict(values)
    if "speeds" in own:
        extra = sorted(own.keys() & {"speed", "heading_deg", "exponent", "factors", "turns_deg"})
        if extra:
            raise CaseError(f"current: speeds and {', '.join(extra)} exclude each other")
        if "depths" not in own:
            raise CaseError("current: speeds need depths")
        return Current.table(**own)
    if "headings_deg" in own:
        raise CaseError("current: headings_deg belongs to speeds at depths; one heading is heading_deg")
    profile: PowerLaw | CurrentTable | None = None
    table = {key: own.pop(key) for key in ("depths", "factors", "turns_deg") if key in own}
    if "exponent" in own:
        if table:
            raise CaseError("current: exponent and depths exclude each other")
        profile = PowerLaw(exponent=own.pop("exponent"))
    elif table:
        profile = CurrentTable(**table)
    return Current(**own, profile=profile)


def wind_of(values: Values, total: float) -> Any:
    """Wind from the values of a case; turbulence (with `seed`) where its intensity is above 0. Raises as `waves_of`."""
    from floatsim.wind.inflow import Wind
    from floatsim.wind.turbulence import Kaimal

    fields, more = Wind.model_fields.keys() - {"turbulence"}, Kaimal.model_fields.keys() - {"intensity"}
    _known("wind", values, ("turbulence_intensity", *sorted(fields), *sorted(more)))
    own = {key: y for key, y in values.items() if key in fields}
    kaimal = {"duration": total, **{key: y for key, y in values.items() if key in more}}
    intensity = values.get("turbulence_intensity", 0)
    return Wind(**own, turbulence=Kaimal(intensity=intensity, **kaimal) if intensity != 0 else None)


def _known(section: str, values: Values, known: tuple[str, ...]) -> None:
    wrong = [key for key in values if key not in known]
    if wrong:
        raise CaseError([f"{section}: there is no '{key}'{nearest(key, known)}" for key in wrong])


def environment_of(case: Case) -> dict[str, Any]:
    """The objects of a case's environment by 'waves', 'current', 'wind'; those it does not speak of are left out."""
    total = case.run.total
    makers: dict[str, Callable[[Values], Any]] = {
        "waves": lambda values: waves_of(values, total), "current": current_of,
        "wind": lambda values: wind_of(values, total),
    }  # fmt: skip
    return {name: makers[name](values) for name, values in case.environment.items()}


def parameters_of(case: Case) -> dict[str, Any]:
    """Parameters of build(): lists as tuples, {"file": name} as a path from the script's folder."""

    def real(value: Any) -> Any:
        if isinstance(value, Mapping) and value.keys() == {"file"}:
            return str(Path(case.model).parent / value["file"])
        if isinstance(value, Mapping):
            return {name: real(item) for name, item in value.items()}
        return tuple(map(real, value)) if isinstance(value, list | tuple) else value

    return {name: real(value) for name, value in case.parameters.items()}


def build_case(case: Case) -> Model:
    """The model of a case. Raises ModelError or CaseError for a script, parameters or an environment that cannot be.

    The script is read anew: nothing it may remember goes from one case to the next.
    """
    return build_with(Script(case.model), case)


def build_with(script: Script, case: Case) -> Model:
    """`build_case` with a script that has been read."""
    environment, parameters = environment_of(case), parameters_of(case)
    for name in environment.keys() & parameters.keys():
        raise CaseError(f"'{name}' is given twice, in parameters and as a section of its own")
    if "wind" in environment and "wind" not in script.takes:
        raise ModelError(
            f"model script '{script.path}': the case has wind, but build() takes no 'wind' that it could put on a rotor"
        )
    given = {name: item for name, item in environment.items() if name in script.takes}
    model = script({**parameters, **given})
    into_sea = {name: item for name, item in environment.items() if name not in given}
    if not into_sea:
        return model
    return model.model_copy(update={"sea": model.sea.model_copy(update=into_sea)})
