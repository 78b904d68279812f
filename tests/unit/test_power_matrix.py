"""Power matrix: cells against linear theory, failures, energy of a year, bad input."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from shipped import MODELS

import floatsim as fs

sys.path.insert(0, str(MODELS))  # model scripts import their neighbours, as when they are run
import rm3  # noqa: E402

ROW = "power matrix"
START, DURATION, STEP = 120.0, 150.0, 0.1
HS, TP = (0.4, 0.8), (7.0, 9.0)


@pytest.fixture(scope="module")
def model() -> fs.Model:
    return rm3.build(wave_ramp=40.0, mooring=rm3.MOORING_STIFFNESS)


@pytest.fixture(scope="module")
def matrix(model) -> fs.PowerMatrix:
    said = []
    done = fs.power_matrix(model, HS, TP, duration=DURATION, start=START, dt=STEP, seed=5, components=200,
                           progress=lambda k, n: said.append((k, n)))  # fmt: skip
    assert said == [(1, 4), (2, 4), (3, 4), (4, 4)]
    return done


def linear_velocity(model: fs.Model, waves: fs.IrregularWaves, t: np.ndarray) -> np.ndarray:
    """PTO velocity by superposition of the frequency domain's responses, after the ramp."""
    sea = waves.realise(model.sea.depth, model.gravity)
    response = fs.frequency_response(model, np.linspace(0.2, 3.9, 75), channels=["pto_velocity"])
    H = np.interp(sea.omega, response.omega, response.rao("pto_velocity"), left=0.0, right=0.0)
    return np.real(np.exp(1j * np.outer(t, sea.omega)) @ (sea.amplitude * H * np.exp(1j * sea.phase)))


def test_cells_against_the_frequency_domain(record, model, matrix):
    """P = c mean(v^2) of the very waves of each cell, summed up from the frequency domain."""
    assert matrix.failures == {} and matrix.power.shape == (2, 2)
    t = START + STEP * np.arange(round(DURATION / STEP) + 1)
    worst = 0.0
    for i, hs in enumerate(HS):
        for j, tp in enumerate(TP):
            waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=hs, tp=tp), seed=5 + 2 * i + j, components=200)
            v = linear_velocity(model, waves, t)
            P = rm3.PTO_DAMPING * np.trapezoid(v**2, t) / DURATION
            worst = max(worst, abs(matrix.power[i, j] / P - 1.0))
    record(ROW, "cells against the same waves in the frequency domain: largest difference", 100.0 * worst, 2.0, "%")
    np.testing.assert_array_equal(matrix.power, matrix.pto["pto"])


@pytest.mark.slow
def test_mean_power_is_c_sigma_squared(record, model):
    """P = c sigma^2 of the spectrum, on average over an hour and a half; by chance a cell is off by a few per cent."""
    hs, tp = 0.5, 8.0
    cells = [fs.power_matrix(model, [hs], [tp], duration=1800.0, start=START, seed=k).power[0, 0] for k in (1, 2, 3)]
    response = fs.frequency_response(model, np.linspace(0.2, 3.9, 150), spectrum=fs.Jonswap(hs=hs, tp=tp))
    P = rm3.PTO_DAMPING * float(response.std("pto_velocity")) ** 2
    error = 100.0 * abs(np.mean(cells) / P - 1.0)
    record(ROW, "mean power of three half hours against c sigma^2 from the spectrum: difference", error, 5.0, "%")


def test_annual_energy():
    power = np.array([[1e3, 2e3], [np.nan, 4e3]])
    share = np.array([[0.25, 0.5], [0.0, 0.125]])
    made = fs.PowerMatrix(np.array([1.0, 2.0]), np.array([6.0, 8.0]), power, {"pto": power}, share)
    assert made.annual_energy == pytest.approx(8766.0 * 3600.0 * (250.0 + 1000.0 + 500.0), rel=1e-12)
    data = made.dataset()
    assert data.power.dims == ("hs", "tp") and data.pto_power.attrs["units"] == "W"
    assert float(data.occurrence.sum()) == 0.875
    with pytest.raises(fs.CaseError, match="needs occurrence"):
        _ = fs.PowerMatrix(made.hs, made.tp, power, {"pto": power}).annual_energy
    share = np.array([[0.25, 0.5], [0.1, 0.125]])
    failures = {(2.0, 6.0): "it broke"}
    with pytest.raises(fs.CaseError, match="1 sea states that occur have no power, the first is hs 2 m, tp 6 s: it br"):
        _ = fs.PowerMatrix(made.hs, made.tp, power, {"pto": power}, share, failures).annual_energy


def test_failed_cells_are_kept():
    """A law that cannot go on when its displacement is large, and a sea that cannot be: other cells stand."""
    force = ((1.0, 1.0), (0.0, 0.0), (-1.0, -1.0))
    table = fs.ForceTable(displacement=(-0.3, 0.0, 0.3), velocity=(-9.0, 9.0), force=force)
    model = rm3.build(laws=[table], wave_ramp=5.0)

    def spectrum(hs: float, tp: float) -> fs.Jonswap:
        if tp > 9.0:
            raise fs.ModelError("no such sea")
        return fs.Jonswap(hs=hs, tp=tp)

    made = fs.power_matrix(model, [0.1, 6.0], [8.0, 10.0], duration=30.0, start=10.0, spectrum=spectrum)
    assert np.isfinite(made.power[0, 0]) and np.isnan(made.power[1]).all() and np.isnan(made.power[0, 1])
    assert set(made.failures) == {(6.0, 8.0), (0.1, 10.0), (6.0, 10.0)}
    assert "no such sea" in made.failures[0.1, 10.0] and "table" in made.failures[6.0, 8.0]
    assert any("no such sea" in str(y) for y in made.dataset().attrs.values())


def test_cells_that_do_not_occur_are_not_run(model):
    made = fs.power_matrix(model, [0.5], [7.0, 9.0], occurrence=[[0.0, 0.25]], duration=10.0, start=40.0)
    assert np.isnan(made.power[0, 0]) and made.failures == {}
    assert made.annual_energy == pytest.approx(8766.0 * 3600.0 * 0.25 * made.power[0, 1])


BAD = {
    "model": (lambda m: fs.power_matrix(3, [1.0], [8.0]), "must be a floatsim.Model"),
    "hs": (lambda m: fs.power_matrix(m, [-1.0], [8.0]), "hs: got .* positive numbers"),
    "nan": (lambda m: fs.power_matrix(m, [1.0], [np.nan]), "tp: got .* positive numbers"),
    "empty": (lambda m: fs.power_matrix(m, [], [8.0]), "hs: got"),
    "twice": (lambda m: fs.power_matrix(m, [1.0, 1.0], [8.0]), "each value once"),
    "pto": (lambda m: fs.power_matrix(m, [1.0], [8.0], ptos=["pot"]), "there is no PTO 'pot'.*'pto'"),
    "shape": (lambda m: fs.power_matrix(m, [1.0], [8.0], occurrence=[0.1]), r"occurrence has shape \(1,\)"),
    "sum": (lambda m: fs.power_matrix(m, [1.0], [8.0], occurrence=[[1.2]]), "sum 1.2"),
    "duration": (lambda m: fs.power_matrix(m, [1.0], [8.0], duration=0.0), "duration: got 0.0"),
    "start": (lambda m: fs.power_matrix(m, [1.0], [8.0], start=20.0), "grow for 40 s"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input(model, case):
    call, message = BAD[case]
    with pytest.raises(fs.CaseError, match=message):
        call(model)


def test_model_without_pto():
    model = fs.Model(parts=[fs.PointMass(name="stone", mass=1.0, position=(0, 0, 1))], sea=fs.Sea(depth=50.0))
    with pytest.raises(fs.ModelError, match="has no PTO"):
        fs.power_matrix(model, [1.0], [8.0])


def test_read_occurrence(tmp_path):
    file = tmp_path / "scatter.csv"
    file.write_text("hs,6,8\n1,0.1,0.2\n2.5,0.3,0.15\n")
    hs, tp, share = fs.read_occurrence(file)
    np.testing.assert_array_equal(hs, [1.0, 2.5])
    np.testing.assert_array_equal(tp, [6.0, 8.0])
    np.testing.assert_array_equal(share, [[0.1, 0.2], [0.3, 0.15]])
    for text in ("", "hs,6\n", "hs,6,8\n1,0.1\n", "hs,6\n1,often\n", "hs\n1\n"):
        file.write_text(text)
        with pytest.raises(fs.CaseError, match="scatter.csv'"):
            fs.read_occurrence(file)
    with pytest.raises(fs.CaseError, match="nothing.csv"):
        fs.read_occurrence(tmp_path / "nothing.csv")


def test_scatter_tables_of_spreadsheets(tmp_path):
    """With an empty corner, with a word in it, or without a column for it."""
    for corner in (",", "hs,", ""):
        file = tmp_path / "scatter.csv"
        file.write_text(f"{corner}6,8\n1,0.3,0.2\n2,0.1,0.4\n")
        hs, tp, share = fs.read_occurrence(file)
        assert (hs.tolist(), tp.tolist(), share.tolist()) == ([1.0, 2.0], [6.0, 8.0], [[0.3, 0.2], [0.1, 0.4]])
