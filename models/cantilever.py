"""A clamped beam with a weight at its tip: Euler's elastica, and the yardstick of bending in lines.

A line without weight of its own, EI 2 MN m2, clamped horizontally, carries a dead load at its tip. Its closed form is
exact for large deflections. Cases: 10 m with 1 or 2 t, 20 m with 1, 2 or 4 t; the MoorDyn paper (Hall et al. 2020,
Fig. 6) and the HAWC2 cable study (Verelst et al. 2024, Fig. 3) use such beams to find how many elements bending needs.
With tip_mass=0, mass_per_length=100 and gravity=0 it swings in vacuum at
1.8751^2/(2 pi) sqrt(EI/(m L^4)) = 0.7914 Hz for L = 10 m.

Run as a script it draws how beams of 2, 4, 6 and 8 elements settle from their undeflected shape.
"""

import math

import floatsim as fs

HEIGHT = 100.0  # of the root over the water [m]
EI = 2.0e6  # N m2
GRAVITY = 9.80665  # m/s2
SETTLING_MASS = 1.0  # kg/m of the beam that settles: without mass its nodes would have no inertia to follow


def build(
    length: float = 10.0,
    tip_mass: float = 1000.0,
    elements_per_metre: float = 1.0,
    elements: int | None = None,
    mass_per_length: float = 1e-6,
    damping_time: float = 0.0,
    gravity: float = GRAVITY,
) -> fs.Model:
    """length [m], tip_mass [kg] (0: none), elements_per_metre or elements (of the whole length), mass_per_length
    [kg/m], damping_time tau [s] (bending damping EI tau), gravity [m/s2]."""
    count = elements if elements is not None else max(1, round(elements_per_metre * length))
    beam = fs.Section(
        name="beam", mass_per_length=mass_per_length, diameter=1e-3, EA=1e10, EI=EI, bending_damping=EI * damping_time
    )
    root, tip = (0.0, 0.0, HEIGHT), (length, 0.0, HEIGHT)
    parts: list[object] = [fs.Line(name="beam", section=beam, length=length, elements=count, end_b_position=tip)]
    joints: list[object] = [fs.Clamp(name="root", a="beam.end_a", b=root, direction=(1.0, 0.0, 0.0))]
    if tip_mass > 0.0:
        parts.append(fs.PointMass(name="tip", mass=tip_mass, position=tip))
        joints.append(fs.Ball(name="load", a="beam.end_b", b="tip"))
    return fs.Model(
        name="cantilever", parts=parts, joints=joints, sea=fs.Sea(depth=50.0), gravity=gravity,
    )  # fmt: skip


def settling(elements: int, duration: float = 20.0, dt: float = 0.01) -> fs.Run:
    """The beam of 10 m let go undeflected with 1 t at its tip, half of critically damped by its own bending."""
    omega = math.sqrt(3.0 * EI / (1000.0 * 10.0**3))  # of the tip mass, small deflection
    system = fs.assemble(build(elements=elements, mass_per_length=SETTLING_MASS, damping_time=1.0 / omega))
    return fs.simulate(system, duration, dt, state=system.initial_state(), channels=["tip_position"])


def main(path: str = "cantilever_settling.png") -> None:
    """Tip height over time for 2, 4, 6 and 8 elements beside the elastica."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(8.0, 4.5), layout="constrained")
    for elements in (2, 4, 6, 8):
        run = settling(elements)
        axes.plot(run.time, run.series("tip_position")[:, 2] - HEIGHT, label=f"{elements} elements")
    axes.axhline(-1.591703, color="black", linestyle="--", linewidth=0.8, label="elastica, beam without weight")
    axes.set(xlabel="time [s]", ylabel="height of the tip [m]", title="Cantilever, 10 m, 1 t at its tip")
    axes.legend()
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main()
