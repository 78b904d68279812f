"""UMaine VolturnUS-S with the IEA 15 MW turbine and its three chain moorings in 200 m of water.

Sources: [AG] Allen et al. 2020, "Definition of the UMaine VolturnUS-S reference platform", NREL/TP-5000-76773;
[DECK] the public OpenFAST and MoorDyn decks of IEA-15-240-RWT-UMaineSemi (Apache-2.0); [TAB] the tabular
workbook of the same repository. Rigid turbine. Without a wind nothing aerodynamic acts; with one the rotor of iea15.py
turns, its nacelle faces the mean wind, and the tower has drag.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import floatsim as fs

DENSITY, GRAVITY = 1025.0, 9.81  # kg/m3, m/s2 [DECK]
VOLUME = 20206.35  # m3, displaced at 20 m draught, from the published dimensions [AG, DECK PtfmVol0]

PLATFORM_MASS = 1.7838e7  # kg, hull and ballast [DECK]
PLATFORM_INERTIA = (1.2507e10, 1.2507e10, 2.3667e10)  # kg m2 about its centre of mass [DECK]
TOWER_MASS = 1_466_499.0  # kg [DECK]
TOWER_CM_Z = 58.19  # m [DECK]
TOWER_INERTIA = 1.4249e9  # kg m2, xx = yy about its own centre of mass [DECK]
TOWER_TOP = (0.0, 0.0, 144.386)  # m [DECK]
TOWER_BASE, TOWER_DIAMETER = (0.0, 0.0, 15.0), (10.0, 6.5)  # m; at base and top [TAB]
RNA_MASS = 945_914.0  # kg [TAB]
RNA_CM = (-7.311, -0.100, 4.596)  # m from the tower top [TAB]
RNA_INERTIA = (3.7834e8, 2.7155e8, 2.5248e8, 1.8945e7)  # kg m2 about the tower top: xx, yy, zz, xz [TAB]

# whole system as the deck sums it up, with its platform centre of mass at -14.40 m [DECK, ElastoDyn summary]
DECK_PLATFORM_CM_Z = -14.40
DECK_MASS = 20_252_259.0  # kg
DECK_CM = (-0.3486, 0.0, -1.497)  # m
DECK_INERTIA = (4.399e10, 4.388e10, 2.393e10, 1.037e9)  # kg m2 about the origin: xx, yy, zz, xz coupling

# F_i = - sum_j B_ij |v_j| v_j about the origin [DECK, AddBQuad]
QUADRATIC_DAMPING = (
    (9.23e5, 0.0, 0.0, 0.0, -8.92e6, 0.0),
    (0.0, 9.23e5, 0.0, 8.92e6, 0.0, 0.0),
    (0.0, 0.0, 2.30e6, 0.0, 0.0, 0.0),
    (0.0, 8.92e6, 0.0, 1.68e10, 0.0, 0.0),
    (-8.92e6, 0.0, 0.0, 0.0, 1.68e10, 0.0),
    (0.0, 0.0, 0.0, 0.0, 0.0, 4.80e10),
)

FAIRLEADS = ((-58.0, 0.0, -14.0), (29.0, 50.229, -14.0), (29.0, -50.229, -14.0))  # m [DECK]
ANCHORS = ((-837.6, 0.0, -200.0), (418.8, 725.383, -200.0), (418.8, -725.383, -200.0))  # m [DECK]
CHAIN_LENGTH = 850.0  # m [DECK]

HYDRO = Path(__file__).with_name("volturnus_s_hydro.nc")  # made by volturnus_s_bem.py


def about_center(mass: float, cm: np.ndarray, inertia: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Inertia about `cm` moved to `point` (parallel axes)."""
    d = cm - point
    return inertia + mass * (d @ d * np.eye(3) - np.outer(d, d))


def rigid_sum(platform_cm_z: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre of mass and inertia about it, of platform, tower and rotor-nacelle assembly."""
    top = np.array(TOWER_TOP)
    xx, yy, zz, xz = RNA_INERTIA
    at_top = np.array([[xx, 0.0, xz], [0.0, yy, 0.0], [xz, 0.0, zz]])
    d = np.array(RNA_CM)
    parts = [
        (PLATFORM_MASS, np.array([0.0, 0.0, platform_cm_z]), np.diag(PLATFORM_INERTIA)),
        (TOWER_MASS, np.array([0.0, 0.0, TOWER_CM_Z]), np.diag([TOWER_INERTIA, TOWER_INERTIA, 0.0])),
        (RNA_MASS, top + d, at_top - RNA_MASS * (d @ d * np.eye(3) - np.outer(d, d))),
    ]
    mass = sum(m for m, _, _ in parts)
    cm = sum(m * c for m, c, _ in parts) / mass
    return mass, cm, sum(about_center(m, c, inertia, cm) for m, c, inertia in parts)


def deck_sum() -> tuple[float, np.ndarray, np.ndarray]:
    """The deck's own sums."""
    xx, yy, zz, xz = DECK_INERTIA
    cm = np.array(DECK_CM)
    origin = np.array([[xx, 0.0, xz], [0.0, yy, 0.0], [xz, 0.0, zz]])
    return DECK_MASS, cm, origin - DECK_MASS * (cm @ cm * np.eye(3) - np.outer(cm, cm))


def steady(wind: fs.Wind | float | None) -> fs.Wind | None:
    """A number is the speed of a steady wind along x [m/s]."""
    return fs.Wind(speed=wind) if isinstance(wind, int | float) else wind


def faced(wind: fs.Wind | None, sums: tuple[float, np.ndarray, np.ndarray]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre of mass and inertia with the nacelle turned to face the wind: all the rest is round."""
    if wind is None:
        return sums
    (c, s, _), (mass, cm, inertia) = wind.direction, sums
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return mass, turn @ cm, turn @ inertia @ turn.T


def turbine(wind: fs.Wind | None) -> list[fs.Rotor]:
    """The rotor with its tower, if there is a wind."""
    if wind is None:
        return []
    import iea15  # beside this script; without a wind the platform does well alone

    tower = fs.Tower(base=TOWER_BASE, top=TOWER_TOP, diameter=TOWER_DIAMETER)
    return [iea15.rotor("platform", TOWER_TOP, tower)]


def chain(name: str = "chain") -> fs.Section:
    """Studless chain of the moorings, R3, nominal 185 mm [DECK]."""
    return fs.Section(
        name=name, mass_per_length=685.0, diameter=0.333, EA=3.27e9, axial_damping_ratio=1.0,
        drag_normal=2.0, drag_tangential=0.4, added_mass_normal=0.82, added_mass_tangential=0.27,
    )  # fmt: skip


def build(
    depth: float = 200.0,
    platform_cm_z: float = -14.94,
    hydro: str | Path | object = HYDRO,
    deck_sums: bool | None = None,
    elements: int = 50,
    moorings: bool = True,
    quadratic_damping: bool = True,
    waves: object = None,
    current: fs.Current | None = None,
    wind: fs.Wind | float | None = None,
) -> fs.Model:
    """VolturnUS-S, floating and moored.

    depth [m]. platform_cm_z [m]: -14.94 as published [AG], -14.40 as in the deck. hydro: database or its path.
    deck_sums: take the deck's sums of mass and inertia; default: when platform_cm_z is the deck's. elements: of
    each chain. moorings, quadratic_damping: leave them out. waves, current: see floatsim.Sea.
    wind: floatsim.Wind, or the speed of a steady one [m/s], which adds the turning rotor and the tower's drag.
    """
    wind = steady(wind)
    if deck_sums is None:
        deck_sums = platform_cm_z == DECK_PLATFORM_CM_Z
    mass, cm, inertia = faced(wind, deck_sum() if deck_sums else rigid_sum(platform_cm_z))
    J = inertia
    platform = fs.Body(
        name="platform",
        mass=mass,
        center_of_mass=cm,
        inertia=(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]),
        points={f"fairlead_{k}": p for k, p in enumerate(FAIRLEADS, 1)},
        hydro=fs.PotentialFlow(
            database=hydro,
            displaced_volume=VOLUME,
            quadratic_damping=QUADRATIC_DAMPING if quadratic_damping else np.zeros((6, 6)),
        ),
    )
    parts: list[object] = [platform, *turbine(wind)]
    joints = []
    if moorings:
        section = chain()
        for k, anchor in enumerate(ANCHORS, 1):
            line = fs.Line(name=f"mooring_{k}", section=section, length=CHAIN_LENGTH, elements=elements)
            parts.append(line)
            joints.append(fs.Ball(a=f"{line.name}.end_a", b=(anchor[0], anchor[1], -depth)))
            joints.append(fs.Ball(a=f"{line.name}.end_b", b=f"platform.fairlead_{k}"))
    return fs.Model(
        name="volturnus_s",
        parts=parts,
        joints=joints,
        sea=fs.Sea(depth=depth, density=DENSITY, waves=waves, current=current or fs.Current(speed=0.0)),
        wind=wind,
        gravity=GRAVITY,
        expected=fs.Expected(
            periods_s={"surge": 142.0, "sway": 142.0, "heave": 20.4, "roll": 27.7, "pitch": 27.7},
            source="Allen et al. 2020 (decay tests of the definition report)",
        ),
    )
