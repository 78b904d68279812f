"""A square net of knots joined by short lines, hung at its rim: the system that no chain elimination fits.

n x n knots stand on a square grid; every two neighbours, and every outer knot and the fixed rim beside it, are joined
by a line. With slack the net hangs as a bag, with negative slack it is stretched like a drum. Polyamide twine,
its weight and stiffness of a size usual in aquaculture.

Stretched by T per length and loaded by q per area a net of many meshes sags like a membrane, T laplacian(w) = -q:
in the middle of a square of side a by 0.0737 q a^2 / T (Timoshenko & Goodier, Theory of Elasticity, membrane analogy).
"""

from __future__ import annotations

import math

import floatsim as fs

DENSITY, GRAVITY = 1025.0, 9.81  # kg/m3, m/s2
TWINE_DENSITY = 1140.0  # kg/m3, polyamide
YOUNG = 1.0e9  # Pa, of the twine


def twine(diameter: float) -> fs.Section:
    """Polyamide twine as a solid cylinder of `diameter` [m]."""
    area = 0.25 * math.pi * diameter**2
    return fs.Section(
        name="twine",
        mass_per_length=TWINE_DENSITY * area,
        diameter=diameter,
        EA=YOUNG * area,
        axial_damping_ratio=0.1,
        drag_normal=1.2,
        drag_tangential=0.01,
        added_mass_normal=1.0,
    )


def build(
    n: int = 20,
    mesh: float = 0.5,
    slack: float = 0.05,
    elements: int = 2,
    diameter: float = 0.01,
    knot_mass: float = 0.1,
    upright: bool = False,
    depth: float = 50.0,
    middle: float = -25.0,
    current: fs.Current | None = None,
) -> fs.Model:
    """n: knots along a side. mesh [m]: distance of neighbours as drawn. slack [-]: by which lines are longer than
    that. elements: of each line. diameter [m] of the twine. knot_mass [kg]. upright: in the plane x = 0 instead of
    lying in z = middle. depth [m]; middle [m]: height of the net's centre."""
    section = twine(diameter)
    half = 0.5 * (n + 1)

    def position(i: int, j: int) -> tuple[float, float, float]:
        u, v = (i - half) * mesh, (j - half) * mesh
        return (0.0, u, middle + v) if upright else (u, v, middle)

    def inner(i: int, j: int) -> bool:
        return 1 <= i <= n and 1 <= j <= n

    inside = range(1, n + 1)
    parts: list[object] = [
        fs.PointMass(name=f"knot_{i}_{j}", mass=knot_mass, position=position(i, j)) for i in inside for j in inside
    ]
    joints = []
    along_u = [(f"u_{i}_{j}", (i, j), (i + 1, j)) for i in range(n + 1) for j in inside]
    along_v = [(f"v_{i}_{j}", (i, j), (i, j + 1)) for i in inside for j in range(n + 1)]
    for name, a, b in along_u + along_v:
        length = mesh * (1.0 + slack)
        parts.append(fs.Line(name=name, section=section, length=length, elements=elements, taut=slack <= 0.0))
        for end, node in (("end_a", a), ("end_b", b)):
            joints.append(fs.Ball(a=f"{name}.{end}", b="knot_{}_{}".format(*node) if inner(*node) else position(*node)))
    return fs.Model(
        name="net",
        parts=parts,
        joints=joints,
        sea=fs.Sea(depth=depth, density=DENSITY, current=current or fs.Current(speed=0.0)),
        gravity=GRAVITY,
    )
