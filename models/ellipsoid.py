"""Flat ellipsoid in steep waves: the nonlinear-hydrodynamics example of WEC-Sim.

    python models/ellipsoid.py [PICTURE]        H 2 m, T 6 s, linear beside nonlinear

Semi-axes 5, 5 and 2.5 m, half submerged in 70 m of water of 1000 kg/m3, 134.2 t, heave only, a damper of 1.2e6 N s/m
to the ground (WEC-Sim, Applications repository, Nonlinear_Hydro: surface and WAMIT output of the half ellipsoid,
moments about the centre of mass 2 m under the water). The example's folder also holds WAMIT files of another,
flatter ellipsoid, 4.5, 4.5 and 1.8 m (its `.hst`, `.1`, `.3fk` displace 76.2 m3); that is not the one that it runs.

134.2 t are 3.3 t more than the half ellipsoid displaces, so it floats 42 mm deeper than drawn. The reference point is
the centre of mass, which slides on a vertical guide; moments of inertia (a homogeneous ellipsoid's) do nothing.
"""

from __future__ import annotations

import sys
from pathlib import Path

import sphere

import floatsim as fs

SEMI_AXES = (5.0, 2.5)  # m, horizontal and vertical
MASS, CENTER_OF_MASS_Z = 1.342e5, -2.0  # kg, m under the water
DAMPING = 1.2e6  # N s/m
HEIGHT, PERIOD = 2.0, 6.0  # m, s
DEPTH, DENSITY, GRAVITY = 70.0, 1000.0, 9.81

HYDRO = Path(__file__).with_name("ellipsoid_hydro.nc")  # made by ellipsoid_bem.py
CHANNELS = ["ellipsoid_position", "ellipsoid_velocity", "ellipsoid_acceleration", "pto_force"]


def build(
    nonlinear: bool = True,
    height: float = HEIGHT,
    period: float = PERIOD,
    damping: float = DAMPING,
    around: int = 48,
    rings: int = 60,
    hydro: str | Path | object = HYDRO,
    wave_ramp: float = 24.0,
) -> fs.Model:
    """The ellipsoid with its damper in a regular wave of `height` [m] (0: still water) and `period` [s].

    nonlinear: Froude-Krylov and hydrostatic pressure on a mesh of 2 * around * (rings - 1) triangles instead of the
    linear ones. damping [N s/m]: zero leaves the damper out. hydro: another database. wave_ramp [s]: see floatsim.Sea.
    """
    a, c = SEMI_AXES
    surface = sphere.mesh(SEMI_AXES, around, rings)
    hull = fs.Hull(mesh=surface, mesh_origin=(0.0, 0.0, -CENTER_OF_MASS_Z)) if nonlinear else None
    body = fs.Body(
        name="ellipsoid", mass=MASS, inertia=(*(MASS / 5.0 * (a * a + c * c),) * 2, MASS * 0.4 * a * a),
        position=(0.0, 0.0, CENTER_OF_MASS_Z),
        hydro=fs.PotentialFlow(database=hydro, hull=hull, memory=30.0, memory_grid=0.05),
    )  # fmt: skip
    parts: list[object] = [body]
    if damping:
        parts.append(fs.PTO(name="pto", joint="guide", laws=[fs.Linear(damping=damping)]))
    return fs.Model(
        name="ellipsoid",
        parts=parts,
        joints=[fs.Slider(name="guide", a="ellipsoid", b=(0.0, 0.0, CENTER_OF_MASS_Z), axis=(0.0, 0.0, 1.0))],
        sea=fs.Sea(
            depth=DEPTH, density=DENSITY, wave_ramp=wave_ramp,
            waves=fs.RegularWave(height=height, period=period) if height else None,
        ),
        gravity=GRAVITY,
    )  # fmt: skip


def main(path: str = "ellipsoid.png") -> None:
    """Heave, and the force on the ellipsoid (mass times acceleration)."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (heave, force) = plt.subplots(2, 1, figsize=(8.0, 5.5), sharex=True, layout="constrained")
    for nonlinear in (False, True):
        run = fs.simulate(build(nonlinear), 72.0, 0.05)
        label = "nonlinear" if nonlinear else "linear"
        heave.plot(run.time, run.series("ellipsoid_position")[:, 2], label=label)
        force.plot(run.time, MASS * run.series("ellipsoid_acceleration")[:, 2] / 1e3, label=label)
    heave.set(ylabel="heave [m]")
    force.set(xlabel="time [s]", ylabel="total force [kN]")
    heave.legend()
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
