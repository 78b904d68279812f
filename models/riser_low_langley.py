"""The flexible riser of Low & Langley (2006), hung between two points in mid-water.

170 m of pipe between (-100, 0, -55) and (0, 0, -5) m; every number is from the input of the MoorDyn repository's test
of that paper (BSD-3, tests/Mooring/lowe_and_langley_2006), whose OrcaFlex curves are what it is compared with.
Case 1 swings the upper end along x, case 4 sends a regular wave past fixed ends.

Source of the case: Low & Langley (2006), dynamic analysis of a flexible hanging riser in the time and frequency domain,
25th OMAE conference.
"""

import math

import numpy as np

import floatsim as fs

TOP, BOTTOM = (0.0, 0.0, -5.0), (-100.0, 0.0, -55.0)  # m
AMPLITUDE, PERIOD = 10.0, 27.0  # m, s: of the upper end in case 1
LEAD = PERIOD  # s over which its motion grows; the published curve starts when it is full
WAVE_HEIGHT, WAVE_PERIOD = 10.0, 10.0  # m, s: case 4
WAVE_PHASE_DEG = -230.0  # the crest passes the origin 230 degrees after the time zero of the published curve


def swinging_top() -> fs.Motion:
    """Case 1: x = A sin(2 pi t/T), grown over one period by 6 f^5 - 15 f^4 + 10 f^3, f = t/T."""
    w = 2.0 * math.pi / PERIOD

    def ramp(t: float) -> tuple[float, float, float]:
        f = min(max(t / LEAD, 0.0), 1.0)
        value = f**3 * (6.0 * f * f - 15.0 * f + 10.0)
        rate = 30.0 * f * f * (f - 1.0) ** 2 / LEAD
        return value, rate, 60.0 * f * (f - 1.0) * (2.0 * f - 1.0) / LEAD**2

    def position(t: float) -> np.ndarray:
        return np.array([AMPLITUDE * ramp(t)[0] * math.sin(w * t), 0.0, TOP[2]])

    def velocity(t: float) -> np.ndarray:
        g, dg, _ = ramp(t)
        return np.array([AMPLITUDE * (dg * math.sin(w * t) + g * w * math.cos(w * t)), 0.0, 0.0])

    def acceleration(t: float) -> np.ndarray:
        g, dg, ddg = ramp(t)
        along = (ddg - g * w * w) * math.sin(w * t) + 2.0 * dg * w * math.cos(w * t)
        return np.array([AMPLITUDE * along, 0.0, 0.0])

    return fs.Motion(position, velocity, acceleration)


def build(case: int = 0, elements: int = 170) -> fs.Model:
    """case: 0 (at rest), 1 (moving upper end, full from t = 27 s on) or 4 (regular wave); elements: 170 of 1 m
    (the published input has 68)."""
    if case not in (0, 1, 4):
        raise fs.ModelError(f"riser_low_langley: case is {case!r}; 0, 1 or 4 is allowed")
    pipe = fs.Section(
        name="pipe", mass_per_length=165.0, diameter=0.396, EA=500.0e6, EI=120.8e3, axial_damping_ratio=0.5,
        drag_normal=1.0, added_mass_normal=1.0,
    )  # fmt: skip
    line = fs.Line(name="riser", section=pipe, length=170.0, elements=elements, end_b_position=TOP)
    top = fs.Prescribed(name="top", a="riser.end_b", motion=swinging_top()) if case == 1 else fs.Ball(
        name="top", a="riser.end_b", b=TOP)  # fmt: skip
    waves = fs.RegularWave(height=WAVE_HEIGHT, period=WAVE_PERIOD, phase_deg=WAVE_PHASE_DEG) if case == 4 else None
    return fs.Model(
        name="riser_low_langley",
        parts=[line],
        joints=[fs.Ball(name="bottom", a="riser.end_a", b=BOTTOM), top],
        sea=fs.Sea(depth=100.0, density=1000.0, waves=waves, wave_ramp=WAVE_PERIOD),
        gravity=9.807,
    )
