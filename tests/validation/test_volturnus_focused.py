"""VolturnUS-S at 1:70 in focused groups: crest, hull, periods, variants, and linear runs against the frequency domain.

Periods: Allen et al. 2020 (NREL/TP-5000-76773), scaled; the soft springs change those of heave and pitch little.
"""

from __future__ import annotations

import math
import sys
import time
from functools import lru_cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from shipped import MODELS

import floatsim as fs

sys.path.insert(0, str(MODELS))  # model scripts import their neighbours, as when they are run
import volturnus_focused_1to70 as model  # noqa: E402

CHECK, FOCUS = "VolturnUS-S 1:70 in focused waves", "focused wave"
PLANE = [0, 2, 4]  # surge, heave, pitch


@lru_cache(maxsize=16)
def run(which: str, share: float = 1.0, variant: str = "linear") -> fs.Run:
    """A group with `share` of its crest."""
    group = model.group(which)
    waves = fs.FocusedWave(**{**dict(group), "crest": share * group.crest})
    return fs.simulate(model.build(waves, **model.VARIANTS[variant]), model.DURATION, model.STEP)


def motions(run: fs.Run) -> np.ndarray:
    return run.series("platform_position")[:, PLANE]


@pytest.mark.parametrize("which", model.GROUPS)
def test_crest_at_the_given_place_and_time(record, which):
    _, crest = model.GROUPS[which]
    done = run(which)
    elevation = done.series("wave_elevation")
    at = round(model.FOCUS / model.STEP)
    assert done.time[at] == pytest.approx(model.FOCUS, abs=1e-9)
    record(FOCUS, f"1:70, crest {crest} m: elevation of the run at the focus, relative error",
           abs(elevation[at] / crest - 1.0), 5e-3)  # fmt: skip
    assert np.argmax(elevation) == at and np.argmax(np.abs(elevation)) == at
    elsewhere = model.group(which, position=(1.5, -0.8)).realise(model.DEPTH, model.GRAVITY)
    record(FOCUS, f"1:70, crest {crest} m at (1.5, -0.8): relative error",
           abs(elsewhere.elevation(1.5, -0.8, model.FOCUS) / crest - 1.0), 5e-3)  # fmt: skip
    assert elsewhere.elevation(0.0, 0.0, model.FOCUS) < 0.9 * crest


@pytest.mark.parametrize("size", [6.0, 4.5, 3.0])
def test_closed_hull(record, size):
    """Volumes are exact: polygons have the areas of the circles."""
    hull = fs.Hull(mesh=model.closed_hull(size))  # closed and outward, or refused
    volume, waterplane, _, height = model.bem.exact_geometry()
    still = hull.hydrostatics()
    error = max(abs(still.volume / volume - 1.0), abs(still.centre_of_buoyancy[2] / height - 1.0),
                abs(hull.enclosed_volume / (volume + model.FREEBOARD * waterplane) - 1.0))  # fmt: skip
    record(CHECK, f"hull of {len(hull.surface.faces)} triangles: volumes and centre of buoyancy, relative error",
           error, 1e-9)  # fmt: skip
    assert 1500 < len(hull.surface.faces) < 4000


def test_floats_level_with_its_periods(record):
    for variant in ("linear", "Froude-Krylov"):
        system = fs.assemble(model.build(None, **model.VARIANTS[variant]))
        state, _ = fs.solve_static(system)
        assert np.abs(state.x[0]).max() < 1e-6 and np.abs(state.q[0][1:]).max() < 1e-6
        found: dict[str, float] = {}
        for mode in fs.natural_modes(system, state):
            found.setdefault(mode.label.split(",")[0].split()[1], mode.period)
        for dof, period in (("surge", 142.0), ("sway", 142.0), ("heave", 20.4), ("pitch", 27.7), ("roll", 27.7)):
            record(CHECK, f"{variant}: {dof} period over the published one to scale",
                   found[dof] / (period * math.sqrt(model.SCALE)), (0.98, 1.02))  # fmt: skip


def transfer(omega: np.ndarray) -> np.ndarray:
    """Surge, heave and pitch per amplitude (n, 3) from mass, database and springs, by linear algebra."""
    db = model.database()
    mass, cm, J = model.inertia()
    M = np.diag([mass, mass, J[1, 1] + mass * (cm[0] ** 2 + cm[2] ** 2)])
    M[0, 2] = M[2, 0] = mass * cm[2]
    spring = model.build(None).parts[1]
    k, T = spring.stiffness, spring.stiffness * model.STRETCH
    r, length = model.SCALE * (model.bem.OUTER_DISTANCE + model.bem.OUTER_RADIUS), model.SPRING_LENGTH
    C = db.hydrostatic_stiffness[np.ix_(PLANE, PLANE)].copy()
    C[2, 2] += -mass * model.GRAVITY * cm[2] + 1.5 * T * r * (1.0 + r / length)
    C[1, 1] += 3.0 * T / length
    C[0, 0] += 1.5 * (k + T / length)
    force = CubicSpline(db.omega, db.excitation[:, np.argmin(np.abs(db.headings)), PLANE])
    out = []
    for w in omega:
        A, B = (matrix[np.ix_(PLANE, PLANE)] for matrix in db.at(w))
        out.append(np.linalg.solve(C - w * w * (M + A) + 1j * w * B, force(w)))
    return np.array(out)


@pytest.mark.slow
@pytest.mark.parametrize("which", model.GROUPS)
def test_linear_run_is_the_sum_of_its_responses(record, which):
    """A fiftieth of the crest, so that the springs' change of direction does not count. At its own periods the platform
    hardly radiates (damping ratios below 2e-4): what the start and, in the periodic sum, the groups before have set
    ringing rings on. So free oscillations at these periods, fitted, may be between run and sum."""
    done = run(which, 0.02)
    group = model.group(which)
    sea = fs.FocusedWave(**{**dict(group), "crest": 0.02 * group.crest}).realise(model.DEPTH, model.GRAVITY)
    late = done.time > 16.0
    t = done.time[late]
    each = transfer(sea.omega) * (sea.amplitude * np.exp(1j * sea.phase))[:, None]
    want = np.real(np.exp(1j * np.outer(t, sea.omega)) @ each)
    difference = motions(done)[late] - want
    modes = [next(mode for mode in fs.natural_modes(model.build(None)) if mode.label.startswith(f"platform {dof}"))
             for dof in ("surge", "heave", "pitch")]  # fmt: skip
    assert max(mode.damping_ratio for mode in modes) < 2e-4
    free = np.column_stack([f(mode.omega * t) for mode in modes for f in (np.cos, np.sin)])
    difference -= free @ np.linalg.lstsq(free, difference)[0]
    off = np.abs(difference).max(axis=0) / np.abs(motions(done)).max(axis=0)
    for dof, error in zip(("surge", "heave", "pitch"), off):
        record(CHECK, f"{which} group, linear: {dof} against the frequency domain, error over the peak", error, 0.005)


@pytest.mark.slow
@pytest.mark.parametrize("which", model.GROUPS)
def test_nonlinear_froude_krylov_is_linear_in_small_waves(record, which):
    """A two-hundredth of the crest. The difference is of second order in the waves, and so halves when they halve."""
    off = []
    for share in (0.01, 0.005):
        linear, mesh = motions(run(which, share)), motions(run(which, share, "Froude-Krylov"))
        off.append(np.sqrt(np.mean((mesh - linear) ** 2, axis=0) / np.mean(linear**2, axis=0)))
    for k, dof in enumerate(("surge", "heave", "pitch")):
        record(CHECK, f"{which} group, crest/200: {dof} with nonlinear Froude-Krylov against linear, rms",
               float(off[1][k]), 0.01)  # fmt: skip
    assert off[1][0] == pytest.approx(0.5 * off[0][0], rel=0.15)  # surge: mean drift


@pytest.mark.slow
@pytest.mark.parametrize("variant", model.VARIANTS)
@pytest.mark.parametrize("which", model.GROUPS)
def test_all_variants_run(record, which, variant):
    done = run(which, 1.0, variant)
    assert done.status == "done", done.failure
    if variant == "linear":
        return
    linear, q = np.abs(motions(run(which))).max(axis=0), np.abs(motions(done)).max(axis=0)
    for k, dof in enumerate(("surge", "heave", "pitch")):
        ratio = q[k] / linear[k]
        record(CHECK, f"{which} group, {variant}: largest {dof} over the linear one", ratio, "runs; reported",
               holds=bool(0.5 < ratio < 2.0))  # fmt: skip


@pytest.mark.slow
def test_steep_group_twice_as_high_survives():
    """Crest of 0.254 m: higher than the freeboard of 0.214 m, kA = 0.27."""
    group = model.group("long")
    waves = fs.FocusedWave(**{**dict(group), "crest": 2.0 * group.crest})
    done = fs.simulate(model.build(waves, hull=True, drag=True), model.DURATION, model.STEP)
    assert done.status == "done", done.failure
    assert np.abs(motions(done)).max() < 1.0


def test_drag_of_columns_and_bottoms(record):
    """Force on the platform that moves without rotating in still water: 1/2 rho Cd A v^2."""
    system = fs.assemble(model.build(None, drag=True))
    rho, L = model.DENSITY, model.SCALE
    keel = (20206.35 - 446.695 * 13.0) / 7.0 * L**2  # volume and waterplane area below and above the pontoons' top
    front = (3.0 * 12.5 * 20.0 + 10.0 * 13.0) * L**2
    for axis, area, drag in ((0, front, 1.0), (2, keel, 1.9)):
        state = system.initial_state()
        state.v[axis] = 0.3
        done = fs.simulate(system, 1e-3, 1e-3, state=state)
        force = done.series("platform_member_force")[0, axis]
        name = "columns, moving sideways" if axis == 0 else "bottoms, moving up"
        record(CHECK, f"drag of the {name}: relative error", abs(force / (-0.5 * rho * drag * area * 0.09) - 1.0), 1e-3)


@pytest.mark.slow
def test_speed(record):
    system = fs.assemble(model.build("short", hull=True))
    start, _ = fs.solve_static(system)
    fs.simulate(system, 0.1, model.STEP, state=start)
    began = time.process_time()
    done = fs.simulate(system, model.DURATION, model.STEP, state=start)
    factor = model.DURATION / (time.process_time() - began)
    assert done.status == "done"
    record(CHECK, "nonlinear Froude-Krylov, 2500 triangles, dt 0.01 s: times faster than the basin", factor,
           "5 at least", holds=factor >= 5.0)  # fmt: skip
