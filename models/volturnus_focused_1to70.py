"""VolturnUS-S at 1:70 in focused wave groups: linear, with nonlinear Froude-Krylov forces, or with drag.

    python models/volturnus_focused_1to70.py        runs both groups with all variants and prints extremes, in minutes

Everything is volturnus_s.py to scale by Froude's law, its hydrodynamic database included. The groups are NewWaves of a
Pierson-Moskowitz spectrum, Tp 1.383 s with a crest of 0.064 m and 1.938 s with 0.127 m (11.6 s, 4.5 m and 16.2 s, 8.9 m
at full scale), both of steepness k A = 0.14. Full-scale dimensions: [AG] Allen et al. 2020, NREL/TP-5000-76773.

Assumptions, where nothing is public or nothing is said:
- water 200 m / 70 = 2.857 m deep, fresh, 1000 kg/m3; masses follow the water's density;
- instead of the chains three soft horizontal springs at the still waterline, from the outer columns outwards, that give
  the platform's published surge period (142 s at full scale) and never get slack;
- what the chains pull down with is ballast at the height of their fairleads, placed so that the platform floats level;
- waves above 2 Hz are left out, as a wavemaker's are; the group focuses at the platform's axis;
- drag (CD 1.0 on the columns, 1.9 on the bottoms): "columns" are the outer ones from keel to deck and the centre one
  above the pontoons, "bottoms" the whole keel plane: four discs under the columns, three under each pontoon with its
  area. There is no other drag; without it nothing but the waves it makes damps the platform.
"""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import volturnus_s
import volturnus_s_bem as bem

import floatsim as fs
from floatsim.hydro.mean_surface import with_froude_krylov

SCALE = 1.0 / 70.0
DEPTH, DENSITY, GRAVITY = 200.0 * SCALE, 1000.0, 9.81  # m, kg/m3, m/s2
FREEBOARD = 15.0  # m, of the columns at full scale [AG]
GROUPS = {"short": (1.383, 0.064), "long": (1.938, 0.127)}  # Tp s, crest m
VARIANTS: dict[str, dict[str, bool]] = {"linear": {}, "Froude-Krylov": {"hull": True}, "drag": {"drag": True}}
FOCUS, DURATION, RAMP, STEP = 20.0, 30.0, 5.0, 0.01  # s
OMEGA_MAX = 4.0 * math.pi  # rad/s
COLUMN_CD, BOTTOM_CD = 1.0, 1.9
PANEL = 4.5  # m at full scale: about 2000 triangles
SURGE_PERIOD = 142.0  # s at full scale [AG]
SPRING_LENGTH, STRETCH = 10.0, 0.5  # m, from column to wall, and of it beyond the free length
BALLAST_Z = -14.0  # m at full scale, of the fairleads


def closed_hull(size: float = PANEL) -> tuple[np.ndarray, np.ndarray]:
    """Vertices [m] and faces of the whole platform at full scale, columns up to the freeboard, decks and keel included.

    The wetted panels of volturnus_s_bem.py in panels of `size` [m] and, on the edge where they end, the freeboard; the
    lids of the columns, lifted, are the decks. Polygons have the areas of the circles: volumes are exact.
    """
    sector, lid = bem.sector_mesh(size)
    hull = bem.six_images(sector)
    vertices, faces = (np.asarray(array) for array in hull)
    edges = {(int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1)) if a != b}
    rim = np.array([edge for edge in sorted(edges) if edge[::-1] not in edges])
    heights = np.linspace(0.0, FREEBOARD, round(FREEBOARD / size) + 1)
    walls = []
    for low, high in zip(heights, heights[1:]):
        a, b = vertices[rim[:, 0]], vertices[rim[:, 1]]
        corners = np.stack([b + (0, 0, low), a + (0, 0, low), a + (0, 0, high), b + (0, 0, high)], axis=1)
        walls.append((corners.reshape(-1, 3), np.arange(4 * len(rim)).reshape(-1, 4)))
    flat, turned = (np.asarray(array) for array in bem.six_images(lid))
    deck = np.column_stack([flat[:, :2], np.full(len(flat), FREEBOARD)]), turned[:, ::-1]
    joined = bem.join((vertices, faces), *walls, deck)
    return np.asarray(joined[0]), np.asarray(joined[1])


@lru_cache(maxsize=2)
def database(path: str | Path = volturnus_s.HYDRO) -> fs.HydroDatabase:
    """The platform's database at model scale, Froude-Krylov part included."""
    return with_froude_krylov(fs.HydroDatabase.read(path).scaled(SCALE, DENSITY))


def inertia() -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre of mass and inertia about it, of the ballasted model."""
    mass, cm, J = volturnus_s.rigid_sum(-14.94)
    extra = volturnus_s.DENSITY * volturnus_s.VOLUME - mass
    place = np.array([-mass * cm[0] / extra, -mass * cm[1] / extra, BALLAST_Z])
    total = mass + extra
    center = (mass * cm + extra * place) / total
    J = volturnus_s.about_center(mass, cm, J, center)
    J = J + volturnus_s.about_center(extra, place, np.zeros((3, 3)), center)
    water = DENSITY / volturnus_s.DENSITY
    return water * SCALE**3 * total, SCALE * center, water * SCALE**5 * J


def drag_loads() -> list[Any]:
    """Members of the columns and discs of the bottoms, drag alone."""
    loads: list[Any] = []
    reach = bem.OUTER_DISTANCE - bem.OUTER_RADIUS - bem.CENTRE_RADIUS  # of a pontoon between the columns
    volume, waterplane, _, _ = bem.exact_geometry()
    keel = (volume + waterplane * bem.PONTOON_TOP) / (bem.PONTOON_TOP - bem.KEEL)  # its area, that of columns included
    share = 2.0 * math.sqrt((keel - waterplane) / 9.0 / math.pi)  # diameter of a disc of a third of a pontoon's

    def column(x: float, y: float, low: float, diameter: float) -> fs.Member:
        return fs.Member(a=SCALE * np.array([x, y, low]), b=SCALE * np.array([x, y, FREEBOARD]), buoyancy=False,
                         diameter=SCALE * diameter, drag_normal=COLUMN_CD)  # fmt: skip

    def bottom(radius: float, angle: float, diameter: float) -> fs.Disc:
        at = SCALE * np.array([radius * math.cos(angle), radius * math.sin(angle), bem.KEEL])
        return fs.Disc(at=at, diameter=SCALE * diameter, drag=BOTTOM_CD)

    loads += [column(0.0, 0.0, bem.PONTOON_TOP, 2.0 * bem.CENTRE_RADIUS), bottom(0.0, 0.0, 2.0 * bem.CENTRE_RADIUS)]
    for angle in math.pi + 2.0 * math.pi / 3.0 * np.arange(3):
        x, y = bem.OUTER_DISTANCE * math.cos(angle), bem.OUTER_DISTANCE * math.sin(angle)
        loads.append(column(x, y, bem.KEEL, 2.0 * bem.OUTER_RADIUS))
        loads.append(bottom(bem.OUTER_DISTANCE, angle, 2.0 * bem.OUTER_RADIUS))
        loads += [bottom(bem.CENTRE_RADIUS + (k + 0.5) / 3.0 * reach, angle, share) for k in range(3)]
    return loads


def group(which: str, position: tuple[float, float] = (0.0, 0.0)) -> fs.FocusedWave:
    """One of GROUPS."""
    tp, crest = GROUPS[which]
    return fs.FocusedWave(spectrum=fs.PiersonMoskowitz(hs=crest, tp=tp), crest=crest, time=FOCUS, position=position,
                          duration=DURATION, omega_max=OMEGA_MAX)  # fmt: skip


def build(
    waves: Any = "short",
    hull: bool = False,
    drag: bool = False,
    ramp: float = RAMP,
    panel: float = PANEL,
    hydro: str | Path | fs.HydroDatabase = volturnus_s.HYDRO,
) -> fs.Model:
    """The model in the basin.

    waves: "short" or "long", one of GROUPS, or a description of waves, or None. hull: nonlinear Froude-Krylov forces
    and hydrostatics on a mesh with panels of `panel` [m at full scale]. drag: Morison drag. ramp [s]: of the waves.
    hydro: the database at model scale, or the path of the full-scale one.
    """
    db = hydro if isinstance(hydro, fs.HydroDatabase) else database(hydro)
    time = math.sqrt(SCALE)
    mass, cm, J = inertia()
    flow = fs.PotentialFlow(database=db, memory=60.0 * time, memory_grid=0.1 * time,
                            hull=fs.Hull(mesh=closed_hull(panel), scale=SCALE) if hull else None)  # fmt: skip
    omega = 2.0 * math.pi / (SURGE_PERIOD * time)
    stiffness = (mass + db.at(omega)[0][0, 0]) * omega**2 / 1.5 / (1.0 + STRETCH / SPRING_LENGTH)
    points, springs, radius = {}, [], SCALE * (bem.OUTER_DISTANCE + bem.OUTER_RADIUS)
    for k, angle in enumerate(math.pi + 2.0 * math.pi / 3.0 * np.arange(3), 1):
        direction = np.array([math.cos(angle), math.sin(angle), 0.0])
        points[f"column_{k}"] = radius * direction
        springs.append(fs.Spring(name=f"spring_{k}", a=f"platform.column_{k}", b=(radius + SPRING_LENGTH) * direction,
                                 stiffness=stiffness, free_length=SPRING_LENGTH - STRETCH))  # fmt: skip
    platform = fs.Body(
        name="platform", mass=mass, center_of_mass=cm, points=points,
        inertia=(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]), hydro=[flow, *(drag_loads() if drag else [])],
    )  # fmt: skip
    return fs.Model(
        name="volturnus_focused_1to70",
        parts=[platform, *springs],
        sea=fs.Sea(depth=DEPTH, density=DENSITY, waves=group(waves) if isinstance(waves, str) else waves,
                   wave_ramp=ramp, stretching="wheeler"),
        gravity=GRAVITY,
        expected=fs.Expected(
            periods_s={"surge": SURGE_PERIOD * time, "sway": SURGE_PERIOD * time},
            source="Allen et al. 2020, scaled; the springs are made for it",
        ),
    )  # fmt: skip


def main() -> None:
    for which, (tp, crest) in GROUPS.items():
        print(f"Tp {tp} s, crest {crest} m: smallest and largest surge [m], heave [m], pitch [deg]")
        for name, options in VARIANTS.items():
            run = fs.simulate(build(which, **options), DURATION, STEP)
            q = run.series("platform_position")[:, [0, 2, 4]] * (1.0, 1.0, 180.0 / math.pi)
            text = "   ".join(f"{low:8.4f} {high:8.4f}" for low, high in zip(q.min(axis=0), q.max(axis=0)))
            print(f"  {name:14s} {text}   {run.status} {run.failure}, {run.wall_time:.1f} s")


if __name__ == "__main__":
    main()
