"""UMaine VolturnUS-S in 82 m of water with two lazy-wave power cables, the site of Verelst et al. 2024.

    python models/volturnus_s_82m.py        the equilibrium: weights, draught, end forces, cable shapes

Platform, turbine and chain are those of volturnus_s.py; the hydrodynamic database was computed for this depth. The
chains are 821 m long with anchors 853 m from the centre. Ballast is unchanged: chains in shallow water pull with a
third of their vertical force in 200 m, and the platform floats as much higher as `main` prints. They have 100 elements:
with 50, of 16 m, every node that lands on the bed is felt at the fairlead, and in a sea of Hs 6 m almost half of the
standard deviation of the leeward chains' tension is that and no physics (20 % with 100, 4 % with 200).

Cables are those of lazy_wave.py, 2.76 x 82 m long, hinged at one point of the platform's bottom and led away
opposite to each other. They hang 62 m high, not 82 m as in the source. With anchors 129 m from the hang-off, bed
tension and largest curvature would be those of lazy_wave.py, but the hog 4 m below the keel, and a current of 0.5 m/s
along the cables, which takes the platform 4 m with it, would push the downstream one together on a bed without
friction. At 170 m that current leaves it 1.5 kN on the bed and the hog 9.5 m below the floating keel; in still water it
is 3.5 kN and 12.6 m, and the largest curvature 0.105 1/m. The hull does not stop a cable.
"""

from __future__ import annotations

import math
from itertools import accumulate, pairwise
from pathlib import Path

import lazy_wave
import volturnus_s

import floatsim as fs

DEPTH = 82.0  # m
CHAIN_LENGTH, ANCHOR_RADIUS = 821.0, 853.0  # m, unstretched, and from the centre
HANG_OFF = (0.0, 0.0, -20.0)  # m, bottom of the centre column
# what utilisations refer to: chain R3 by DNV-OS-E302, 0.0223 d^2 (44 - 0.08 d) kN with d = 185 mm; of the cable's
# limits nothing is published: 15 diameters, and a breaking load that is usual for its size
CHAIN_BREAKING_LOAD = 22.286e6  # N
CABLE_BREAKING_LOAD, CABLE_BEND_RADIUS = 200e3, 3.0  # N, m
CABLE_REACH = 170.0  # m, in plan from the hang-off to a cable's anchor

HYDRO = Path(__file__).with_name("volturnus_s_82m_hydro.nc")  # made by volturnus_s_bem.py --depth 82


def floater(
    hydro: str | Path | object = HYDRO,
    hang_off: tuple[float, float, float] = HANG_OFF,
    wind: fs.Wind | None = None,
) -> fs.Body:
    """The platform of volturnus_s.py with the database of this depth and a point where cables hang."""
    body = volturnus_s.build(hydro=hydro, moorings=False, wind=wind).parts[0]
    return fs.Body(**{**dict(body), "points": {**body.points, "hang_off": hang_off}})


def moorings(elements: int = 100) -> tuple[list[fs.Line], list[fs.Ball]]:
    """The chains, each in the vertical plane of its fairlead, with as many elements each."""
    lines, joints = [], []
    section = fs.Section(**{**dict(volturnus_s.chain()), "breaking_load": CHAIN_BREAKING_LOAD})
    for k, (x, y, _) in enumerate(volturnus_s.FAIRLEADS, 1):
        outwards = ANCHOR_RADIUS / math.hypot(x, y)
        lines.append(fs.Line(name=f"mooring_{k}", section=section, length=CHAIN_LENGTH, elements=elements))
        joints.append(fs.Ball(a=f"mooring_{k}.end_a", b=(outwards * x, outwards * y, -DEPTH)))
        joints.append(fs.Ball(a=f"mooring_{k}.end_b", b=f"platform.fairlead_{k}"))
    return lines, joints


def cable_pieces(element: float) -> list[fs.Piece]:
    """Sections of a lazy wave for this depth in elements of nearly `element` [m], 226 in all at 1 m."""
    pieces = lazy_wave.build(depth=DEPTH).parts[0].pieces
    ends = [round(s / element) for s in accumulate(piece.length for piece in pieces)]
    counts = [max(1, last - first) for first, last in pairwise([0, *ends])]
    limits = {"breaking_load": CABLE_BREAKING_LOAD, "minimum_bend_radius": CABLE_BEND_RADIUS}
    sections = [fs.Section(**{**dict(p.section), **limits}) for p in pieces]
    return [fs.Piece(section=s, length=p.length, elements=n) for s, p, n in zip(sections, pieces, counts, strict=True)]


def power_cables(
    angle_deg: float = 0.0,
    hang_off: tuple[float, float, float] = HANG_OFF,
    reach: float = CABLE_REACH,
    element: float = 1.0,
) -> tuple[list[fs.Line], list[fs.Ball]]:
    """Two lazy waves from `hang_off`, towards angle_deg from +x to +y and opposite; reach [m]: in plan to the anchor;
    element [m]: length, nearly."""
    lines, joints = [], []
    pieces = cable_pieces(element)
    for k, turn in enumerate((0.0, math.pi), 1):
        b = math.radians(angle_deg) + turn
        anchor = (hang_off[0] + reach * math.cos(b), hang_off[1] + reach * math.sin(b), -DEPTH)
        lines.append(fs.Line(name=f"cable_{k}", pieces=pieces, shape=fs.ThreeCircles()))
        joints.append(fs.Ball(a=f"cable_{k}.end_a", b="platform.hang_off"))
        joints.append(fs.Ball(a=f"cable_{k}.end_b", b=anchor))
    return lines, joints


def build(
    cables: bool = True,
    cable_angle_deg: float = 0.0,
    hang_off: tuple[float, float, float] = HANG_OFF,
    cable_reach: float = CABLE_REACH,
    cable_element: float = 1.0,
    elements: int = 100,
    hydro: str | Path | object = HYDRO,
    waves: object = None,
    current: fs.Current | None = None,
    wind: fs.Wind | float | None = None,
) -> fs.Model:
    """VolturnUS-S at 82 m, floating, moored and cabled.

    cables: leave them out with False. cable_angle_deg: of the first cable from +x to +y, the second is opposite.
    hang_off [m]: of both, in the body. cable_reach [m]: in plan from hang-off to anchor. cable_element [m]: length,
    nearly. elements: of each chain. hydro: database or its path. waves, current: see floatsim.Sea. wind:
    floatsim.Wind, or the speed of a steady one [m/s], which adds the turning rotor and the tower's drag.
    """
    wind = volturnus_s.steady(wind)
    lines, joints = moorings(elements)
    if cables:
        more_lines, more_joints = power_cables(cable_angle_deg, hang_off, cable_reach, cable_element)
        lines, joints = lines + more_lines, joints + more_joints
    return fs.Model(
        name="volturnus_s_82m",
        parts=[floater(hydro, hang_off, wind), *volturnus_s.turbine(wind), *lines],
        joints=joints,
        sea=fs.Sea(depth=DEPTH, density=volturnus_s.DENSITY, waves=waves, current=current or fs.Current(speed=0.0)),
        wind=wind,
        gravity=volturnus_s.GRAVITY,
    )


def main() -> None:
    """Print the equilibrium."""
    from floatsim.study.report import static_tables
    from floatsim.study.sheet import body_sheets

    system = fs.assemble(build())
    for sheet in body_sheets(system):
        (x, y, z), up = sheet.attached / 1e3, sheet.net_force[2] / 1e3
        print(f"{sheet.name} as drawn: weight {sheet.weight / 1e3:.1f} kN, buoyancy {sheet.buoyancy / 1e3:.1f} kN,")
        print(f"  chains and cables ({x:.1f}, {y:.1f}, {z:.1f}) kN, left over {up:.1f} kN upwards")
    state, report = fs.solve_static(system)
    for title, heads, rows in static_tables(system, state):
        print(f"\n{title}\n  {', '.join(heads)}")
        for row in rows:
            print(f"  {', '.join(row)}")
    print(f"\nlargest unbalanced force {report.residual_force:.2g} N")


if __name__ == "__main__":
    main()
