"""VolturnUS-S in 82 m with chains and two power cables: equilibrium, chains, cables and periods against other means.

Chains against the elastic catenary, cables against lazy_wave.py hung alone at the same point. Periods: Allen et al.
2020 as quoted by Verelst et al. 2024, Table 4, for what depth hardly changes; surge from a mass on three catenaries,
because mooring and added mass are those of this depth.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
from closed_forms import elastic_catenary
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from shipped import MODELS

import floatsim as fs
from floatsim.study.channels import Sampler
from floatsim.study.release import pose

sys.path.insert(0, str(MODELS))  # model scripts import their neighbours, as when they are run
import lazy_wave  # noqa: E402
import volturnus_s  # noqa: E402
import volturnus_s_82m  # noqa: E402

ROW = "VolturnUS-S in 82 m with chains and cables"
CHAIN = volturnus_s.chain()
CHAIN_WEIGHT = (CHAIN.mass_per_length - 1025.0 * 0.25 * np.pi * CHAIN.diameter**2) * 9.81  # N/m
ANGLE = 25.0  # deg, of the cables


class Solved:
    """A model in static equilibrium, and channels of it."""

    def __init__(self, **parameters: Any) -> None:
        self.system = fs.assemble(volturnus_s_82m.build(**parameters))
        self.state, self.report = fs.solve_static(self.system)
        self._sampler = Sampler(self.system, "all")
        self._row = self._sampler.sample_state(self.state)[None]

    def __call__(self, channel: str) -> np.ndarray:
        return self._sampler.column(self._row, channel)[0]


@pytest.fixture(scope="module")
def rest() -> Solved:
    return Solved(cable_angle_deg=ANGLE)


def chain_pull(fairlead: np.ndarray, anchor: np.ndarray) -> np.ndarray:
    """Force (3,) [N] of the elastic catenary on the fairlead."""
    span = (anchor - fairlead)[:2]
    size = float(np.linalg.norm(span))
    H, _, V, _ = elastic_catenary(size, fairlead[2] - anchor[2], 821.0, CHAIN.EA, CHAIN_WEIGHT, seabed=True)
    return np.array([H * span[0] / size, H * span[1] / size, -V])


def test_chains_are_catenaries(record, rest):
    for k in (1, 2, 3):
        x = rest(f"mooring_{k}_position")
        force, exact = rest(f"mooring_{k}_end_b_force"), chain_pull(x[-1], x[0])
        assert np.hypot(*x[0, :2]) == pytest.approx(853.0, abs=1e-9)
        error = 100.0 * np.linalg.norm(force - exact) / np.linalg.norm(exact)
        record(ROW, f"force of chain {k} on its fairlead against the elastic catenary: error", error, 0.2, "%")


def test_cables_are_those_of_the_lazy_wave(record, rest):
    """Each cable alone, hung from where the platform holds it, with 227 elements of slightly other lengths."""
    for k, turn in ((1, 0.0), (2, 180.0)):
        x = rest(f"cable_{k}_position")
        b = np.radians(ANGLE + turn)
        assert x[-1, :2] == pytest.approx(170.0 * np.array([np.cos(b), np.sin(b)]), abs=1e-9)
        reach = float(np.linalg.norm(x[-1, :2] - x[0, :2]))
        alone = fs.assemble(lazy_wave.build(hang_off=(0.0, 0.0, float(x[0, 2])), x_anchor=reach))
        state, _ = fs.solve_static(alone)
        sampler = Sampler(alone, ["cable_tension", "cable_end_a_force", "cable_curvature"])
        row = sampler.sample_state(state)[None]
        for what, unit, bar in (("tension", 1e3, 0.2), ("curvature", 1.0, 0.5)):
            one, other = np.abs(rest(f"cable_{k}_{what}")).max(), np.abs(sampler.column(row, f"cable_{what}")[0]).max()
            record(ROW, f"cable {k}: largest {what} against the cable alone ({other / unit:.4g}): error",
                   100.0 * abs(one / other - 1.0), bar, "%")  # fmt: skip
        pull, expected = rest(f"cable_{k}_end_a_force"), sampler.column(row, "cable_end_a_force")[0]
        error = 100.0 * abs(np.linalg.norm(pull) / np.linalg.norm(expected) - 1.0)
        record(ROW, f"cable {k}: force at the hang-off against the cable alone: error", error, 0.2, "%")


def test_platform_floats_where_forces_balance(record, rest):
    """Weights, displaced volume and waterplane from the published dimensions, chains as catenaries, cables by their
    weight down to where they lie: what is left over has no business to be there."""
    record(ROW, "largest unbalanced force over the weight of the platform", rest.report.residual_force / 1.98e8, 1e-9)
    mass, _, _ = volturnus_s.rigid_sum(-14.94)
    waterplane = np.pi * (5.0**2 + 3.0 * 6.25**2)  # m2, columns of 10 and 12.5 m [Allen et al. 2020]
    heave = float(pose(rest.system, rest.state, "platform")[2])
    lift = 1025.0 * 9.81 * (volturnus_s.VOLUME - waterplane * heave) - mass * 9.81
    down = -sum(chain_pull(rest(f"mooring_{k}_position")[-1], rest(f"mooring_{k}_position")[0])[2] for k in (1, 2, 3))
    for k in (1, 2):
        line = next(part for part in rest.system.model.parts if part.name == f"cable_{k}")
        z = rest(f"cable_{k}_position")[:, 2]
        w = line.wet_weight(1025.0, 9.81) * line.element_lengths
        hanging = 0.5 * (z[:-1] + z[1:]) > -81.95
        down += float(w[hanging].sum())
    record(ROW, "heave of the equilibrium", heave, (0.40, 0.60), "m")
    error = 100.0 * abs(lift - down) / down
    record(ROW, "lift of the platform against the pull of catenaries and hanging cable: error", error, 0.3, "%")
    net = np.abs([rest(f"mooring_{k}_end_b_force") for k in (1, 2, 3)]).max()
    horizontal = sum(rest(f"mooring_{k}_end_b_force") for k in (1, 2, 3)) + sum(
        rest(f"cable_{k}_end_a_force") for k in (1, 2)
    )
    record(ROW, "sum of horizontal pulls over the largest", np.hypot(*horizontal[:2]) / net, 1e-6)


def test_cables_hardly_move_the_platform(record, rest):
    """Two cables of 16 kN each: their vertical pull over the waterplane's stiffness."""
    bare = Solved(cables=False)
    names = [part.name for part in bare.system.model.parts]
    assert names == ["platform", "mooring_1", "mooring_2", "mooring_3"]
    sinkage = pose(bare.system, bare.state, "platform")[2] - pose(rest.system, rest.state, "platform")[2]
    pull = sum(abs(rest(f"cable_{k}_end_a_force")[2]) for k in (1, 2))
    stiffness = 1025.0 * 9.81 * np.pi * (5.0**2 + 3.0 * 6.25**2)
    record(ROW, "sinkage by the cables against their pull over the waterplane: error",
           100.0 * abs(sinkage * stiffness / pull - 1.0), 6.0, "%")  # fmt: skip


def test_parameters_move_hang_off_and_anchors():
    model = volturnus_s_82m.build(hang_off=(3.0, -2.0, -20.0), cable_angle_deg=90.0, cable_reach=160.0)
    platform = model.parts[0]
    assert platform.points["hang_off"] == (3.0, -2.0, -20.0)
    anchors = {joint.a: joint.b for joint in model.joints}
    assert anchors["cable_1.end_b"] == pytest.approx((3.0, 158.0, -82.0))
    assert anchors["cable_2.end_b"] == pytest.approx((3.0, -162.0, -82.0))
    cables = [part for part in model.parts if part.name.startswith("cable")]
    assert [(cable.elements, round(cable.length, 6)) for cable in cables] == [(226, 226.32)] * 2


@pytest.mark.parametrize(("dof", "published", "offset"), [
    ("heave", 20.4, 3.0), ("roll", 27.7, 5.0), ("pitch", 27.7, 5.0),
])  # fmt: skip
def test_periods_that_depth_hardly_changes(record, dof, published, offset):
    """Heave, roll and pitch are hull and ballast; in 82 m chains are less stiff, and the bed adds to the added mass."""
    test = fs.decay_test(volturnus_s_82m.build(), dof, offset, duration=110.0, channels=["platform_position"])
    low, high = 0.97 * published, 1.03 * published
    record(ROW, f"{dof} period (published for 200 m: {published:g} s)", test.fit.period, (low, high), "s")


@pytest.mark.slow
def test_surge_period(record):
    """First cycle from 5 m downwind against x'' = F(x)/(m + A11): three catenaries, mass and added mass of
    platform and the hanging chain left out. Pitch goes with surge and adds a few per cent to the inertia."""
    offset = 5.0
    test = fs.decay_test(volturnus_s_82m.build(), "surge", offset, duration=330.0, channels=["platform_position"])
    database = volturnus_s_82m.floater().hydro.data
    mass = volturnus_s.rigid_sum(-14.94)[0] + float(np.interp(0.05, database.omega, database.added_mass[:, 0, 0]))
    fairleads = np.array(volturnus_s.FAIRLEADS) + [0.0, 0.0, 0.5]  # it floats half a metre higher
    anchors = np.array([(853.0 / np.hypot(x, y)) * np.array([x, y, 0.0]) for x, y, _ in volturnus_s.FAIRLEADS])
    anchors[:, 2] = -82.0

    def pull(surge: float) -> float:
        return float(sum(chain_pull(f + [surge, 0.0, 0.0], a)[0] for f, a in zip(fairleads, anchors, strict=True)))

    steps = np.linspace(-7.0, 7.0, 57)
    force = np.array([pull(x) for x in steps])
    rest = brentq(lambda x: np.interp(x, steps, force), -1.0, 1.0)

    def motion(_: float, y: np.ndarray) -> tuple[float, float]:
        drag = volturnus_s.QUADRATIC_DAMPING[0][0] * abs(y[1]) * y[1]
        return y[1], (np.interp(y[0] + rest, steps, force) - drag) / mass

    def crest(_: float, y: np.ndarray) -> float:
        return float(y[1])

    crest.direction = -1.0  # type: ignore[attr-defined]
    crests = solve_ivp(motion, (0.0, 200.0), (offset, 0.0), events=crest, max_step=0.5, rtol=1e-8).t_events[0]
    expected = float(crests[crests > 10.0][0])  # it starts from one
    record(ROW, "surge period, first cycle from 5 m", float(test.fit.periods[0]), (0.97 * expected, 1.03 * expected),
           "s")  # fmt: skip


@pytest.mark.slow
def test_ten_minutes_of_sea_and_current(record):
    """Hs 6 m, current 0.5 m/s along the cables: the run ends, few steps are cut, nothing is torn or jammed."""
    waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=6.0, tp=11.0), seed=1, components=200)
    model = volturnus_s_82m.build(waves=waves, current=fs.Current(speed=0.5))
    run = fs.simulate(model, 600.0, 0.1, channels=["platform_position", "cable_1_tension", "cable_2_tension",
                                                   "cable_1_curvature", "mooring_2_tension"])  # fmt: skip
    assert run.status == "done", run.failure
    row = f"{ROW}, Hs 6 m, Tp 11 s, current 0.5 m/s, 600 s"
    late = run.time > 100.0
    record(row, "steps cut", run.cut_steps / run.steps, 0.02, "share")
    surge = run.series("platform_position")[late, 0]
    record(row, "mean surge", float(surge.mean()), (3.5, 6.5), "m")
    # the platform's own drag in the current alone, 231 kN, is 4 m of surge; waves only add to it
    still = Solved(current=fs.Current(speed=0.5))
    assert surge.mean() > pose(still.system, still.state, "platform")[0] - 0.2
    for k in (1, 2):
        top = run.series(f"cable_{k}_tension")[late, 0]
        rest = still(f"cable_{k}_tension")[0]
        record(row, f"cable {k}: mean top tension over that in the current alone", float(top.mean() / rest),
               (0.95, 1.05), "")  # fmt: skip
        record(row, f"cable {k}: largest top tension over that in the current alone", float(top.max() / rest),
               (1.0, 1.3), "")  # fmt: skip
