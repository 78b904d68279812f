"""What OpenFAST 5.0.0 gives for IEA 15 MW on VolturnUS-S with the public deck, and how it is compared.

OpenFAST with the deck IEA-15-240-RWT-UMaineSemi (github.com/IEAWindTask37/IEA-15-240-RWT, Apache-2.0): still water,
no aerodynamics, rotor locked, six rigid degrees of freedom, moorings by MoorDyn. Decays are released from the drawing
position plus the offset. MoorDyn's tension at an end is the force on what the line is attached to.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import floatsim as fs

DECK_CM_Z = -14.40  # m

REST = {"surge": (0.416, "m", 0.03), "heave": (-0.352, "m", 0.03), "pitch": (-1.452, "deg", 0.05)}
END_FORCE = {  # N
    "mooring_1_end_b": 2.417e6, "mooring_2_end_b": 2.432e6, "mooring_3_end_b": 2.432e6, "mooring_1_end_a": 1.342e6,
}  # fmt: skip
TENSION_BAR = 0.005

# extrema about the equilibrium [m or deg], the first at t = 0; first-cycle period [s]
OFFSET = {"surge": 20.0, "heave": 5.0, "pitch": 8.0, "yaw": 10.0}
EXTREMA = {
    "surge": (19.59, -10.85, 6.81, -5.22, 4.00),
    "heave": (5.371, -3.733, 2.992, -2.418, 2.091),
    "pitch": (9.43, -8.19, 7.23, -6.57, 5.87),
    "yaw": (10.0, -6.56, 4.83, -3.83),
}
PERIOD = {"surge": (138.5, 0.02), "heave": (20.82, 0.01), "pitch": (28.54, 0.015), "yaw": (89.6, 0.03)}
EXTREMA_BAR = 0.03
DURATION = {"surge": 300.0, "heave": 60.0, "pitch": 80.0, "yaw": 190.0}  # s


@dataclass(frozen=True)
class Row:
    """One comparison: value and reference in `unit`, difference and bar in `measure`."""

    quantity: str
    value: float
    reference: float
    unit: str
    difference: float
    bar: float
    measure: str


def static_rows(model: fs.Model) -> list[Row]:
    """Equilibrium and line end forces."""
    from floatsim.study.release import pose

    system = fs.assemble(model)
    state, _ = fs.solve_static(system)
    where = pose(system, state, "platform")
    values = {"surge": where[0], "heave": where[2], "pitch": np.degrees(where[4])}
    rows = [
        Row(f"static {name}", float(values[name]), reference, unit, abs(float(values[name]) - reference), bar, unit)
        for name, (reference, unit, bar) in REST.items()
    ]
    for joint, reference in END_FORCE.items():
        row = system.joint_rows[joint][0][0]
        force = float(np.linalg.norm(state.lam[3 * row : 3 * row + 3]))
        difference = 100.0 * abs(force / reference - 1.0)
        rows.append(Row(f"static force at {joint}", force, reference, "N", difference, 100.0 * TENSION_BAR, "%"))
    return rows


def decay_rows(model: fs.Model, dof: str) -> list[Row]:
    """Extrema 2 to 5 and the first period of a decay released from an absolute pose."""
    test = fs.decay_test(
        model, dof, OFFSET[dof], release="absolute", duration=DURATION[dof], channels=["platform_position"]
    )
    unit = "m" if dof in ("surge", "sway", "heave") else "deg"
    first = EXTREMA[dof][0]
    rows = [
        Row(f"{dof} decay, extremum {k + 1}", float(test.fit.value[k]), reference, unit,
            100.0 * abs(float(test.fit.value[k]) - reference) / first, 100.0 * EXTREMA_BAR, "% of the first")
        for k, reference in enumerate(EXTREMA[dof]) if k > 0
    ]  # fmt: skip
    reference, bar = PERIOD[dof]
    period = float(test.fit.periods[0])
    rows.append(Row(f"{dof} decay, first period", period, reference, "s", 100.0 * abs(period / reference - 1.0),
                    100.0 * bar, "%"))  # fmt: skip
    return rows
