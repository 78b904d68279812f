"""A dynamic power cable hung as a lazy wave in 82 m of water, the configuration of Verelst et al. 2024.

Three sections from the hang-off to the anchor, in all 2.76 times the depth as 0.25 / 0.25 / 0.50; the middle one
carries buoyancy. Weights per metre, in air and in water, are those of the source; diameters follow from them (0.200 m,
and 0.428 m where buoyant). Both ends are hinged, the bed has no friction.

Static equilibrium from MoorDyn 2.7.2, fully relaxed, 1 m elements: sag at z -39.82 m, hog at -15.99 m, touchdown at
147 m along the cable, 16.60 kN in the first element, 0.97 kN on the bed, largest moment 2419 N m.
"""

from __future__ import annotations

import floatsim as fs

DENSITY, GRAVITY = 1025.0, 9.81  # kg/m3, m/s2
DRY, WET = 706.0, 390.0  # N/m, cable
DRY_BUOYANT, WET_BUOYANT = 1129.0, -316.0  # N/m, cable with buoyancy
EA, EI = 700e6, 10e3  # N, N m2
DRAG, ADDED_MASS = 1.2, 1.0  # across, of the umbilical of Hall et al. 2020, Table 1
AXIAL_DAMPING = 0.005 * EA  # N s; 5 ms of stress per strain rate, small against any period of interest

SHAPES = {"circles": fs.ThreeCircles(), "catenary": fs.Catenary(), "arc": fs.Arc(), "straight": fs.Straight()}


def section(name: str, dry: float, wet: float) -> fs.Section:
    """Section of given weights in air and in water [N/m]."""
    return fs.Section(
        name=name,
        mass_per_length=dry / GRAVITY,
        diameter=fs.diameter_from_weights(dry, wet, DENSITY, GRAVITY),
        EA=EA,
        EI=EI,
        axial_damping=AXIAL_DAMPING,
        drag_normal=DRAG,
        added_mass_normal=ADDED_MASS,
    )


def build(
    depth: float = 82.0,
    x_anchor: float = 125.0,
    length_per_depth: float = 2.76,
    buoyant_share: float = 0.25,
    wet_buoyant: float = WET_BUOYANT,
    hang_off: tuple[float, float, float] = (0.0, 0.0, 0.0),
    element: float = 1.0,
    shape: str = "circles",
) -> fs.Model:
    """depth [m]; x_anchor [m] on the bed; length_per_depth [-]: total length over depth; buoyant_share [-]: of the
    total length, the upper section is always a quarter of it; wet_buoyant [N/m]: weight in water of the buoyant
    section, at its weight in air; hang_off [m]; element [m]: length, nearly; shape: where statics start from, circles,
    catenary, arc or straight.
    """
    if shape not in SHAPES:
        raise fs.ModelError(f"lazy_wave: shape: got {shape!r}; must be one of {', '.join(SHAPES)}")
    shares = (0.25, buoyant_share, 0.75 - buoyant_share)
    lengths = fs.section_lengths(depth, length_per_depth, shares)
    plain, buoyant = section("cable", DRY, WET), section("buoyant", DRY_BUOYANT, wet_buoyant)
    pieces = [
        fs.Piece(section=part, length=length, elements=max(1, round(length / element)))
        for part, length in zip((plain, buoyant, plain), lengths, strict=True)
    ]
    return fs.Model(
        name="lazy_wave",
        parts=[fs.Line(name="cable", pieces=pieces, shape=SHAPES[shape])],
        joints=[
            fs.Ball(a="cable.end_a", b=hang_off, name="hang_off"),
            fs.Ball(a="cable.end_b", b=(x_anchor, 0.0, -depth), name="anchor"),
        ],
        sea=fs.Sea(depth=depth, density=DENSITY),
        gravity=GRAVITY,
    )
