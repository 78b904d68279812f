"""Mean drift of the shipped VolturnUS-S database against the diagonal of the published QTF.

WAMIT: IEA-15-240-RWT-UMaineSemi.12d, OpenFAST/IEA-15-240-RWT-UMaineSemi/HydroData of
github.com/IEAWindTask37/IEA-15-240-RWT (Apache-2.0): surge, heading 0, 200 m, by pressure on the hull. From 0.85 rad/s
on 82 m are deep. Below, that file's drift is up to 6 kN/m2 larger, and below zero at 0.35 rad/s, which no passive body
alone can have: damping put in and the error of pressure integration, of which long waves leave little else.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from floatsim.hydro.database import HydroDatabase

MODELS = Path(__file__).resolve().parents[2] / "models"
OMEGA = np.arange(17, 29) * 0.05  # rad/s
WAMIT = 1e3 * np.array(
    [68.042, 63.723, 41.245, 72.906, 129.670, 127.215, 82.250, 91.176, 148.620, 149.622, 150.639, 124.495]
)  # N/m2
FILES = ["volturnus_s_82m_hydro.nc", "volturnus_s_hydro.nc"]
CHECK = "mean drift of VolturnUS-S (far field) against WAMIT's QTF diagonal"


@pytest.fixture(params=FILES)
def db(request):
    return HydroDatabase.read(MODELS / request.param)


def test_surge_in_head_waves(db, record):
    ahead = int(np.argmin(np.abs(db.headings)))
    got = db.mean_drift[np.searchsorted(db.omega, OMEGA - 1e-6), ahead, 0]
    rms = float(np.sqrt(np.mean((got - WAMIT) ** 2) / np.mean(WAMIT**2)))
    record(CHECK, f"surge, 0.85 to 1.4 rad/s, {db.depth:g} m: rms of the difference / rms", rms, 0.05)
    record(CHECK, f"surge, 0.85 to 1.4 rad/s, {db.depth:g} m: mean ratio", float(np.mean(got / WAMIT)), (0.93, 1.03))


def test_three_arms(db, record):
    """Waves 120 deg apart meet the same hull (the turbine's overhang apart), and long waves pass."""
    F = db.mean_drift[:, :, 0] + 1j * db.mean_drift[:, :, 1]
    turned = np.roll(F, 24, axis=1) * np.exp(2j * np.pi / 3.0)  # of headings 5 deg apart
    error = float(np.abs(F - turned).max() / np.abs(F).max())
    record(CHECK, f"waves 120 deg apart, {db.depth:g} m: largest difference / largest drift", error, 0.02)
    assert np.abs(F[db.omega < 0.2]).max() < 1e-3 * np.abs(F).max()
    along = (F * np.exp(-1j * db.headings)).real
    assert along.min() > -1e-3 * along.max()
