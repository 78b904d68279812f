"""What a line is made of: cross-sections, pieces in series, bend stiffeners, attachments and breaks."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, SkipValidation, field_validator, model_validator

from floatsim.description import Description, Name, NonNegative, Positive, PositiveInt, is_number, numbers
from floatsim.frames import Array
from floatsim.laws.engineering import Engineering
from floatsim.laws.moment_table import MomentTable
from floatsim.sea.seabed import check_friction

MAX_ELEMENTS = 100_000  # decimetres of the longest cables; more is a slip of the pen
SHORTEST = 1e-6  # m, of an element; coordinates in kilometres carry no more digits

Pair = Annotated[tuple[float, float], numbers("two numbers (at the root, at the tip)", 2)]


def _axial(value: Any) -> Any:
    if value is None or isinstance(value, Engineering):
        return value
    if isinstance(value, type) or not all(hasattr(value, name) for name in ("stiffness", "memory", "bind", "start")):
        raise ValueError(
            f"got {value!r:.60}; Engineering(), TensionTable(...), StaticDynamic(...) or an object with stiffness, "
            "memory, bind and start (floatsim.laws) is allowed, None for linear in Green strain"
        )
    if not isinstance(value.memory, int) or value.memory < 0:
        raise ValueError(f"{type(value).__name__} has a memory of {value.memory!r}; must be a number of rows")
    if not (is_number(value.stiffness) and value.stiffness > 0.0):
        raise ValueError(f"{type(value).__name__} has a stiffness of {value.stiffness!r}; must be a positive number")
    return value


class Section(Description):
    """Cross-section of a line, per unit length.

    name: name. mass_per_length [kg/m]: dry. diameter [m]: volume-equivalent outer diameter, of the
    displaced volume and of drag. EA [N], EI [N m2]. axial_law: None (linear in Green strain) or a law of
    `floatsim.laws`; where it has a stiffness of its own EA is not used. bending_law: None (linear) or MomentTable.
    axial_damping [N s]: force per strain rate, or
    axial_damping_ratio [-]: share of l0 sqrt(EA m) per element (MoorDyn's -zeta); not both.
    bending_damping [N m2 s]: moment times length per angle rate, EI-proportional damping is EI tau.
    drag_normal, drag_tangential [-]: 0.5 rho d Cd and 0.5 rho pi d Cd. added_mass_normal,
    added_mass_tangential [-]: shares of rho A. seabed_friction [-]: (along, across) the line or one number for both,
    None for the seabed's. breaking_load [N], minimum_bend_radius [m]: what utilisations are measured against.
    """

    name: Name
    mass_per_length: Positive
    diameter: Positive
    EA: Positive
    EI: NonNegative = 0.0
    axial_law: Annotated[SkipValidation[Any], AfterValidator(_axial)] = None
    bending_law: MomentTable | None = None
    axial_damping: NonNegative | None = None
    axial_damping_ratio: NonNegative | None = None
    bending_damping: NonNegative = 0.0
    drag_normal: NonNegative = 0.0
    drag_tangential: NonNegative = 0.0
    added_mass_normal: NonNegative = 0.0
    added_mass_tangential: NonNegative = 0.0
    seabed_friction: Annotated[tuple[float, float] | None, BeforeValidator(check_friction)] = None
    breaking_load: Positive | None = None
    minimum_bend_radius: Positive | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Section:
        if self.axial_damping is not None and self.axial_damping_ratio is not None:
            raise ValueError("give axial_damping [N s] or axial_damping_ratio [-], not both")
        if self.bending_damping > 0.0 and not self.bends:
            raise ValueError(f"bending_damping is {self.bending_damping:g} N m2 s but EI is 0: nothing would bend")
        return self

    @property
    def bends(self) -> bool:
        """Whether it has bending stiffness."""
        return self.EI > 0.0 or self.bending_law is not None

    @property
    def area(self) -> float:
        """Displaced cross-section pi d^2/4 [m2]."""
        return 0.25 * math.pi * self.diameter**2

    @property
    def stiffness(self) -> float:
        """Axial stiffness [N]: EA, or the largest of a nonlinear law."""
        return float(getattr(self.axial_law, "stiffness", self.EA))

    def damping(self, element_length: float) -> float:
        """Axial damping of an element, resolved [N s]."""
        if self.axial_damping_ratio is not None:
            return self.axial_damping_ratio * element_length * math.sqrt(self.stiffness * self.mass_per_length)
        return self.axial_damping or 0.0

    def wet_weight(self, density: float, gravity: float) -> float:
        """Weight in water per length [N/m]."""
        return (self.mass_per_length - density * self.area) * gravity


class Piece(Description):
    """A stretch of a line with one section: unstretched length [m] in so many equal elements."""

    section: Section
    length: Positive
    elements: PositiveInt

    @field_validator("elements")
    @classmethod
    def _countable(cls, value: int) -> int:
        if value > MAX_ELEMENTS:
            raise ValueError(f"got {value}; at most {MAX_ELEMENTS} are allowed")
        return value

    @model_validator(mode="after")
    def _resolvable(self) -> Piece:
        if self.length / self.elements < SHORTEST:
            raise ValueError(f"its elements are {self.length / self.elements:.3g} m long; {SHORTEST:g} m is the least")
        return self


class BendStiffener(Description):
    """Tapered sleeve around a clamped line end, from its root at the end to its tip `length` [m] along the line.

    EI [N m2], mass_per_length [kg/m] and diameter [m] as (root, tip), straight in between; EI and mass come on top of
    the line's, the diameter replaces it (the sleeve's volume floats, and drag sees it). It carries no axial
    force: the line slides in it.
    """

    length: Positive
    EI: Pair
    mass_per_length: Pair = (0.0, 0.0)
    diameter: Pair | None = None

    @model_validator(mode="after")
    def _possible(self) -> BendStiffener:
        for name in ("EI", "mass_per_length", "diameter"):
            row = getattr(self, name)
            if row is not None and min(row) < 0.0:
                raise ValueError(f"{name}: got {row}; must not be negative")
        if max(self.EI) == 0.0:
            raise ValueError("EI: got (0, 0); a stiffener without stiffness does nothing")
        return self

    def at(self, name: str, s: Array) -> Array:
        """EI, mass_per_length or diameter at distances s from the end [m]; 0 beyond the tip."""
        root, tip = getattr(self, name)
        return np.asarray(np.where(s < self.length, root + (tip - root) * s / self.length, 0.0))


class Attachment(Description):
    """A clump weight, buoyancy module or clamp at arc length `at` [m] from end a.

    mass [kg], volume [m3], drag_area [m2]: Cd times area in any direction, added_mass [-]: share of rho volume.
    Its loads are shared by the two nodes of its element like those of a simply supported beam.
    """

    name: Name
    at: NonNegative
    mass: NonNegative = 0.0
    volume: NonNegative = 0.0
    drag_area: NonNegative = 0.0
    added_mass: NonNegative = 0.0

    @model_validator(mode="after")
    def _something(self) -> Attachment:
        if self.mass == 0.0 and self.volume == 0.0 and self.drag_area == 0.0:
            raise ValueError("mass, volume and drag_area are all 0: it would do nothing")
        return self


class Break(Description):
    """The line parts at arc length `at` [m] from end a: at a `time` [s], or when the tension there exceeds
    `tension` [N]. The element there is cut in its middle and carries no force from then on."""

    at: NonNegative
    time: NonNegative | None = None
    tension: Positive | None = None

    @model_validator(mode="after")
    def _one_cause(self) -> Break:
        if (self.time is None) == (self.tension is None):
            raise ValueError("give time [s] or tension [N], one and not both")
        return self
