"""Power umbilical of a floating wave-energy converter: lazy wave in 70 m of water.

The cable of Hall et al. 2020 [H], the MoorDyn paper on bending stiffness, Table 1: three sections in series, the
middle one with buoyancy. Public are the sections, the anchor and the sea state (JONSWAP, Hs 8.25 m, Tp 14.5 s), not the
hang-off nor the motion of the device. Both are therefore our own: the cable hangs from (0, 0, -20) of a device that is
moved as prescribed.

    python models/umbilical_rm3.py [PICTURE]    draws what the three kinds of hang-off do to the cable
"""

from __future__ import annotations

import math
import sys
from functools import lru_cache
from pathlib import Path

import numpy as np

import floatsim as fs

DEPTH, DENSITY, GRAVITY = 70.0, 1025.0, 9.81  # m, kg/m3, m/s2
HANG_OFF = (0.0, 0.0, -20.0)  # m from the device's reference point on the still-water line
ANCHOR = (105.1, 0.0, -70.0)  # m; horizontal distance [H]
LENGTHS = (57.0, 25.0, 55.0)  # m, from the hang-off: cable, buoyancy section, cable [H]
HS, TP = 8.25, 14.5  # m, s [H]
SEABED = (1e5, 1e4)  # Pa/m, Pa s/m: a soft bed; the cable touches it near the anchor only

EA, EI = 751e6, 11.71e3  # N, N m2 [H]
AXIAL_DAMPING_TIME = 0.005  # s: force per strain rate over EA. Material damping is not public; this one is small

STIFFENED_LENGTH = 4.0  # m: [H] could not model a bend stiffener and stiffened the first 4 m of the cable instead,
STIFFENED_EI = 60e3  # N m2, to this

# Bend stiffener. [H] names one and gives no drawing. Ours is a cone of polyurethane around the cable, of the length
# that [H] stiffened, 0.40 m in outer diameter at the hang-off and 0.20 m at its tip. Its modulus of 80 MPa is of the
# order of such elastomers and chosen so that sleeve and cable together, 108.5 kN m2 at the root and 14.2 kN m2 at the
# tip and straight in between (a true cone would have less there, 47 on average), have 61 kN m2 on average: it stands
# for the same component as the 60 kN m2 above.
STIFFENER_DIAMETER = (0.40, 0.20)  # m, outer, root and tip
STIFFENER_MODULUS, STIFFENER_DENSITY = 80e6, 1150.0  # Pa, kg/m3

# direction in which a clamped cable leaves the hang-off, in the device's axes: that of the hinged cable at rest
HANG_OFF_DIRECTION = (0.26, 0.0, -0.966)

PERIODS = (14.5, 9.0)  # s, of the benchmark motion
SURGE, HEAVE = (3.0, 0.8), (2.5, 0.5)  # m
RAMP = 20.0  # s


def section(name: str, mass_per_length: float, diameter: float, bending: float = EI) -> fs.Section:
    """A section of the cable. diameter [m]: volume-equivalent [H]; axial drag per wetted surface is ours."""
    return fs.Section(
        name=name, mass_per_length=mass_per_length, diameter=diameter, EA=EA, EI=bending,
        axial_damping=AXIAL_DAMPING_TIME * EA, drag_normal=1.2, drag_tangential=0.05, added_mass_normal=1.0,
    )  # fmt: skip


def benchmark_motion(start: tuple[float, float, float] = HANG_OFF, columns: int = 3) -> fs.Motion:
    """Two-period surge and heave of a point (3 columns) or of a body without rotation (6) from `start` [m].

        x = x0 + r (3.0 sin(w1 t) + 0.8 sin(w2 t)),   z = z0 + r (2.5 cos(w1 t) + 0.5 sin(w2 t) - 2.5)

    with r = (1 - cos(pi t/20))/2 during the first 20 s and 1 after: position and velocity start from rest.
    """
    w1, w2 = (2.0 * math.pi / period for period in PERIODS)
    x0, y0, z0 = start
    still = (0.0,) * (columns - 3)

    @lru_cache(maxsize=1)  # asked three times for each instant
    def ramp(t: float) -> tuple[float, float, float]:
        """r and its first two derivatives."""
        if t >= RAMP:
            return 1.0, 0.0, 0.0
        n = math.pi / RAMP
        return 0.5 * (1.0 - math.cos(n * t)), 0.5 * n * math.sin(n * t), 0.5 * n * n * math.cos(n * t)

    @lru_cache(maxsize=1)
    def swing(t: float) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float]]:
        """(x, z) at full amplitude and the first two derivatives."""
        s1, c1, s2, c2 = math.sin(w1 * t), math.cos(w1 * t), math.sin(w2 * t), math.cos(w2 * t)
        (a1, a2), (b1, b2) = SURGE, HEAVE
        return (
            (a1 * s1 + a2 * s2, b1 * c1 + b2 * s2 - b1),
            (a1 * w1 * c1 + a2 * w2 * c2, -b1 * w1 * s1 + b2 * w2 * c2),
            (-a1 * w1 * w1 * s1 - a2 * w2 * w2 * s2, -b1 * w1 * w1 * c1 - b2 * w2 * w2 * s2),
        )

    def position(t: float) -> tuple[float, ...]:
        (r, _, _), (p, _, _) = ramp(t), swing(t)
        return x0 + r * p[0], y0, z0 + r * p[1], *still

    def velocity(t: float) -> tuple[float, ...]:
        (r, r1, _), (p, v, _) = ramp(t), swing(t)
        return r1 * p[0] + r * v[0], 0.0, r1 * p[1] + r * v[1], *still

    def acceleration(t: float) -> tuple[float, ...]:
        (r, r1, r2), (p, v, a) = ramp(t), swing(t)
        return r2 * p[0] + 2.0 * r1 * v[0] + r * a[0], 0.0, r2 * p[1] + 2.0 * r1 * v[1] + r * a[1], *still

    return fs.Motion(position, velocity, acceleration)


def recorded_motion(path: str | Path) -> fs.Motion:
    """Motion of the device from a text file, through cubic splines.

    Seven columns, separated by blanks or commas, lines that begin with # left out: time [s], displacement of the
    reference point in x, y, z [m], roll, pitch, yaw [deg]. Raises fs.ModelError for a file that is not like that.
    """
    try:
        text = Path(path).read_text()
        rows = np.loadtxt(text.replace(",", " ").splitlines(), ndmin=2)
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise fs.ModelError(f"motion: '{path}' cannot be read as a table of numbers: {error}") from None
    if rows.shape[1] != 7:
        raise fs.ModelError(
            f"motion: '{path}' has {rows.shape[1]} columns; 7 are needed: time [s], x, y, z [m], roll, pitch, yaw [deg]"
        )
    return fs.Motion.from_series(rows[:, 0], np.hstack([rows[:, 1:4], np.radians(rows[:, 4:])]))


def storm(seed: int = 1, components: int = 200) -> fs.IrregularWaves:
    """The sea of [H], travelling from the device towards the anchor."""
    return fs.IrregularWaves(spectrum=fs.Jonswap(hs=HS, tp=TP), seed=seed, components=components, duration=3600.0)


def bend_stiffener() -> fs.BendStiffener:
    """The cone described above. Its EI and mass add to the cable's, its diameter takes the place of the cable's."""
    inner = 0.176
    root, tip = (
        ((D**4 - inner**4) * math.pi / 64.0 * STIFFENER_MODULUS, (D**2 - inner**2) * math.pi / 4.0 * STIFFENER_DENSITY)
        for D in STIFFENER_DIAMETER
    )
    return fs.BendStiffener(
        length=STIFFENED_LENGTH, EI=(root[0], tip[0]), mass_per_length=(root[1], tip[1]), diameter=STIFFENER_DIAMETER
    )


def build(
    elements_per_metre: float = 1.0,
    motion: str = "benchmark",
    ends: str = "hinged",
    waves: object = None,
    current: fs.Current | None = None,
    wave_ramp: float = 100.0,
) -> fs.Model:
    """The umbilical under a moving device.

    elements_per_metre: of all sections. motion: 'benchmark', 'still', or the path of a recorded motion of the device
    (see `recorded_motion`). ends: the hang-off is 'hinged', 'clamped' with the first 4 m stiffened as in [H], or
    'stiffener', clamped with a tapered bend stiffener; the anchor is hinged. waves: None, 'storm' for the sea of [H],
    or see floatsim.Sea, with wave_ramp [s]; they act on the cable, the device moves as prescribed.
    """
    if ends not in ("hinged", "clamped", "stiffener"):
        raise fs.ModelError(f"ends: got {ends!r}; 'hinged', 'clamped' and 'stiffener' are allowed")
    if elements_per_metre <= 0.0:
        raise fs.ModelError(f"elements_per_metre: got {elements_per_metre!r}; must be positive")
    cable, buoyant = section("cable", 77.3, 0.176), section("buoyancy", 184.5, 0.559)
    stretches = list(zip((cable, buoyant, cable), LENGTHS, strict=True))
    if ends == "clamped":
        stiff = section("stiffened", 77.3, 0.176, STIFFENED_EI)
        stretches[:1] = [(stiff, STIFFENED_LENGTH), (cable, LENGTHS[0] - STIFFENED_LENGTH)]
    pieces = [fs.Piece(section=s, length=l, elements=math.ceil(l * elements_per_metre - 1e-9)) for s, l in stretches]
    line = fs.Line(name="umbilical", pieces=pieces, stiffener_a=bend_stiffener() if ends == "stiffener" else None)

    parts: list[object] = [line]
    joints: list[object] = [fs.Ball(a="umbilical.end_b", b=ANCHOR, name="anchor")]
    if ends == "hinged" and motion == "benchmark":
        joints.append(fs.Prescribed(a="umbilical.end_a", motion=benchmark_motion(), name="hang_off"))
    elif ends == "hinged" and motion == "still":
        joints.append(fs.Ball(a="umbilical.end_a", b=HANG_OFF, name="hang_off"))
    else:
        support: str | tuple[float, float, float] = HANG_OFF
        if motion != "still":
            support = "device.hang_off"
            path = benchmark_motion((0.0, 0.0, 0.0), 6) if motion == "benchmark" else recorded_motion(motion)
            x, y, z, roll, pitch, yaw = (float(value) for value in path.start)
            # the device's own mass does not matter: its motion is given
            device = fs.Body(
                name="device", mass=1.6e6, inertia=(1e8, 1e8, 1e8), points={"hang_off": HANG_OFF}, position=(x, y, z),
                attitude_deg=(math.degrees(roll), math.degrees(pitch), math.degrees(yaw)),
            )  # fmt: skip
            parts.append(device)
            joints.append(fs.Prescribed(a="device", motion=path, name="motion"))
        if ends == "hinged":
            joints.append(fs.Ball(a="umbilical.end_a", b=support, name="hang_off"))
        else:
            joints.append(fs.Clamp(a="umbilical.end_a", b=support, direction=HANG_OFF_DIRECTION, name="hang_off"))
    return fs.Model(
        name="umbilical_rm3",
        parts=parts,
        joints=joints,
        sea=fs.Sea(
            depth=DEPTH, density=DENSITY, seabed=fs.Seabed(stiffness=SEABED[0], damping=SEABED[1]),
            waves=storm() if waves == "storm" else waves, wave_ramp=wave_ramp, current=current or fs.Current(speed=0.0),
        ),
        gravity=GRAVITY,
    )  # fmt: skip


def compare_ends(picture: str = "umbilical_rm3.png") -> None:
    """Benchmark motion with the three hang-offs: shape, tension, curvature, and moment near the hang-off."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(2, 2, figsize=(12.0, 8.0), layout="constrained")
    shape, tension, curvature, moment = panels.ravel()
    for ends, style in (("hinged", "-"), ("clamped", "--"), ("stiffener", ":")):
        data = fs.simulate(build(elements_per_metre=2.0, ends=ends), 120.0, 0.05, interval=0.1).dataset()
        at_rest = data["umbilical_position"].isel(time=0)
        data = data.isel(time=data["time"].values >= 60.0)
        shape.plot(at_rest.sel(xyz="x"), at_rest.sel(xyz="z"), style, label=ends)
        pulls, middle = data["umbilical_tension"] / 1e3, data["umbilical_element_arc_length"]
        color = tension.plot(middle, pulls.mean("time"), style, label=ends)[0].get_color()
        tension.fill_between(middle, pulls.min("time"), pulls.max("time"), alpha=0.15, color=color)
        s, bent = data["umbilical_arc_length"], data["umbilical_curvature"].max("time")
        curvature.plot(s, bent, style, label=f"{ends}: {float(bent.max()):.3f} 1/m")
        near = s.values <= 3.0 * STIFFENED_LENGTH
        moment.plot(s[near], data["umbilical_bending_moment"].max("time")[near] / 1e3, style, label=ends)
    shape.axhline(-DEPTH, color="0.5", linewidth=4.0)
    arc = "arc length from the hang-off [m]"
    shape.set(xlabel="x [m]", ylabel="z [m]", title="at rest", aspect="equal")
    tension.set(xlabel=arc, ylabel="tension [kN]", title="mean and range, 60 to 120 s")
    curvature.set(xlabel=arc, ylabel="curvature [1/m]", title="largest, 60 to 120 s")
    moment.set(xlabel=arc, ylabel="bending moment [kN m]", title="largest near the hang-off, 60 to 120 s")
    for axes in panels.ravel():
        axes.legend()
        axes.grid(alpha=0.3)
    figure.savefig(picture, dpi=120)
    print(f"{picture} written")


if __name__ == "__main__":
    compare_ends(*sys.argv[1:2])
