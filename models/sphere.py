"""Two spheres that float half submerged and heave: R 5 m of the OES Task 10, and D 0.3 m of Kramer et al.

    python models/sphere.py [oes|kramer] [PICTURE]      released from 0.1, 0.3 and 0.5 D, linear beside nonlinear

OES: R 5 m, 261.8 t, centre of mass 2 m below the centre, deep water of 1000 kg/m3 (Wendt et al., International Energy
Agency Ocean Energy Systems Task 10 wave energy converter modeling verification and validation, EWTEC 2017).
Kramer: D 300 mm, 7.056 kg, centre of mass 34.8 mm below the centre, 0.9 m of water of 998.2 kg/m3, g 9.82 m/s2 (Kramer
et al., Highly accurate experimental heave decay tests with a floating sphere, Energies 14 (2021) 269).

The reference point is the centre of the sphere, drawn on the water: heave is its height. A slider to the ground leaves
only heave, so moments of inertia (here a homogeneous sphere's) do nothing.

Times go with the root of the size. The radiation memory of the larger sphere is 36 s on a grid of 0.05 s, 50 and 0.07
times sqrt(R/g); that of the smaller one is as long in its own time, 6.2 s on 8.7 ms. On a grid of 0.1 s, which is fine
for platforms, motion at its natural frequency of 8.3 rad/s would be felt 6 % too weakly, and the drop from 30 mm have
crests 2 % (of 30 mm) too high.

The smaller sphere's database is for deep water, too: at its natural frequency the wave number times depth is 6.3, and
tanh of that 1 - 7e-6.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

import floatsim as fs


class Size(NamedTuple):
    """radius m, mass kg, centre of mass m, depth m (deep for OES), density kg/m3, gravity m/s2, database."""

    radius: float
    mass: float
    center_of_mass_z: float
    depth: float
    density: float
    gravity: float
    hydro: Path

    @property
    def time(self) -> float:
        """sqrt(R/g), s."""
        return math.sqrt(self.radius / self.gravity)


SIZES = {  # databases made by sphere_bem.py
    "oes": Size(5.0, 261.8e3, -2.0, 300.0, 1000.0, 9.81, Path(__file__).with_name("sphere_oes_hydro.nc")),
    "kramer": Size(0.15, 7.056, -0.0348, 0.9, 998.2, 9.82, Path(__file__).with_name("sphere_kramer_hydro.nc")),
}
MEMORY, GRID = 50.0, 0.07  # of the radiation, in sqrt(R/g)
STEP = 0.028  # of the runs below, in sqrt(R/g): 0.02 s and 3.5 ms


def mesh(semi_axes: tuple[float, float], around: int, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners [m] and faces of an ellipsoid of revolution about z, (horizontal, vertical) semi-axes [m].

    Flat faces between circles that are polygons of the circles' area, stretched in z to the ellipsoid's volume: half
    submerged, volume and waterplane are exact. 2 * around * (rings - 1) triangles; `rings` must be even.
    """
    a, c = semi_axes
    theta = np.pi * np.arange(rings + 1) / rings
    r, z = np.sin(theta), np.cos(theta)
    cones = -np.diff(z) @ (r[1:] ** 2 + r[1:] * r[:-1] + r[:-1] ** 2) / 3.0  # of volume over pi, exact is 4/3
    phi = 2.0 * np.pi * np.arange(around) / around
    out = a * math.sqrt(phi[1] / math.sin(phi[1])) * r[:, None]
    height = np.repeat(c * 4.0 / 3.0 / cones * z, around)
    corners = np.column_stack([(out * np.cos(phi)).ravel(), (out * np.sin(phi)).ravel(), height])
    i, j = np.divmod(np.arange(rings * around), around)
    k = (j + 1) % around
    upper, lower = i * around, (i + 1) * around
    return corners, np.column_stack([upper + j, lower + j, lower + k, upper + k])


def build(
    size: str = "oes",
    nonlinear: bool = False,
    damping: float = 0.0,
    around: int = 36,
    rings: int = 60,
    memory: float | None = None,
    memory_grid: float | None = None,
    hydro: str | Path | object | None = None,
    waves: object = None,
    wave_ramp: float = 20.0,
) -> fs.Model:
    """A sphere in heave.

    size: "oes" or "kramer". nonlinear: Froude-Krylov and hydrostatic pressure on a mesh of 2 * around * (rings - 1)
    triangles instead of the linear ones. damping [N s/m]: of a PTO between sphere and ground. memory, memory_grid [s]:
    of the radiation, default by size. hydro: another database. waves, wave_ramp [s]: see floatsim.Sea.
    """
    s = SIZES[size]
    hull = fs.Hull(mesh=mesh((s.radius, s.radius), around, rings)) if nonlinear else None
    flow = fs.PotentialFlow(
        database=hydro or s.hydro, hull=hull, memory=memory or MEMORY * s.time, memory_grid=memory_grid or GRID * s.time
    )
    sphere = fs.Body(
        name="sphere", mass=s.mass, inertia=(0.4 * s.mass * s.radius**2,) * 3,
        center_of_mass=(0.0, 0.0, s.center_of_mass_z), hydro=flow,
    )  # fmt: skip
    parts: list[object] = [sphere]
    if damping:
        parts.append(fs.PTO(name="pto", joint="guide", laws=[fs.Linear(damping=damping)]))
    return fs.Model(
        name=f"sphere_{size}",
        parts=parts,
        joints=[fs.Slider(name="guide", a="sphere", b=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0))],
        sea=fs.Sea(depth=s.depth, density=s.density, waves=waves, wave_ramp=wave_ramp),
        gravity=s.gravity,
    )


def drop(size: str, height: float, nonlinear: bool, duration: float | None = None, **parameters: object) -> fs.Run:
    """The sphere released at rest `height` [m] above its equilibrium, for `duration` [s], default five periods."""
    s = SIZES[size]
    test = fs.decay_test(build(size, nonlinear, **parameters), "heave", height, dt=STEP * s.time,
                         duration=duration or 31.0 * s.time)  # fmt: skip
    return test.run


def main(size: str = "kramer", path: str = "sphere_drops.png") -> None:
    """Heave over the height of the drop."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(8.0, 4.5), layout="constrained")
    for share, color in zip((0.1, 0.3, 0.5), ("C0", "C1", "C2"), strict=True):
        height = 2.0 * share * SIZES[size].radius
        for nonlinear, line in ((False, "--"), (True, "-")):
            run = drop(size, height, nonlinear)
            z = run.series("sphere_position")[:, 2]
            axes.plot(run.time, z / height, line, color=color,
                      label=f"{share:g} D, {'nonlinear' if nonlinear else 'linear'}")  # fmt: skip
    axes.set(xlabel="time [s]", ylabel="heave over height of the drop")
    axes.legend()
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
