"""A studless chain on a rough bed whose fairlead heaves: the comparison with OrcaFlex in MoorDyn's repository.

Chain of 390 kg/m with its fairlead at the water surface, 50 or 200 m deep, swung by +-2 m in heave with a period of
10 s (motion "A1"; the recorded file is this sine to its last digit). In 50 m nearly all of the chain lifts off and
falls back.

Source: input and results in tests/Mooring of MoorDyn v2 (BSD-3), with the static forces its test quotes from
quasi-static codes.
"""

from __future__ import annotations

import math

import numpy as np

import floatsim as fs

AMPLITUDE, PERIOD = 2.0, 10.0  # m, s: heave of the fairlead
CASES = {50: (400.0, 410.0, 41), 200: (700.0, 760.0, 76)}  # depth: span [m], length [m], elements of the published run


def heave(lead: float) -> fs.Motion:
    """z = A sin(2 pi t/T), grown over `lead` [s] by 6 f^5 - 15 f^4 + 10 f^3, f = t/lead: no impact at the start."""
    w = 2.0 * math.pi / PERIOD

    def derivatives(t: float) -> tuple[float, float, float]:
        f = min(t / lead, 1.0)
        g = f**3 * (6.0 * f * f - 15.0 * f + 10.0)
        dg = 30.0 * f * f * (f - 1.0) ** 2 / lead
        ddg = 60.0 * f * (f - 1.0) * (2.0 * f - 1.0) / lead**2
        s, c = math.sin(w * t), math.cos(w * t)
        return g * s, dg * s + g * w * c, (ddg - g * w * w) * s + 2.0 * dg * w * c

    def order(n: int):  # type: ignore[no-untyped-def]
        return lambda t: np.array([0.0, 0.0, AMPLITUDE * derivatives(t)[n]])

    return fs.Motion(order(0), order(1), order(2))


def build(depth: int = 200, moving: bool = True, elements: int | None = None, lead: float = PERIOD) -> fs.Model:
    """depth: 50 or 200 m; moving: whether the fairlead heaves (full after `lead` [s]); elements (default: as
    published, 10 m each)."""
    if depth not in CASES:
        raise fs.ModelError(f"chain_orcaflex: depth is {depth!r}; 50 or 200 [m] is allowed")
    span, length, count = CASES[depth]
    chain = fs.Section(
        name="chain", mass_per_length=390.0, diameter=0.252, EA=1.674e9, axial_damping_ratio=1.0,
        drag_normal=1.37, drag_tangential=0.64, added_mass_normal=1.0,
    )  # fmt: skip
    line = fs.Line(name="chain", section=chain, length=length, elements=elements or count, end_b_position=(0, 0, 0))
    fairlead = fs.Prescribed(name="fairlead", a="chain.end_b", motion=heave(lead)) if moving else fs.Ball(
        name="fairlead", a="chain.end_b", b=(0.0, 0.0, 0.0))  # fmt: skip
    return fs.Model(
        name="chain_orcaflex",
        parts=[line],
        joints=[fs.Ball(name="anchor", a="chain.end_a", b=(span, 0.0, -float(depth))), fairlead],
        sea=fs.Sea(depth=depth, density=1025.0, seabed=fs.Seabed(stiffness=1e5, damping=1e4, friction=0.5)),
    )
