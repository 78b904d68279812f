"""Excitation against a floater whose transfer function is known at every frequency and heading.

Long-wave (Froude-Krylov) force on slender vertical cylinders in deep water: each, of waterplane area S and draught D
at (x, y), feels rho g S exp(-k D) exp(-i k x') in heave, x' the distance along the wave, and i rho w^2 S D exp(-i k x')
along the wave's direction at half the draught; enough to have the phases, cross terms and harmonics over the heading
of a semi-submersible.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from floatsim.errors import ModelError
from floatsim.hydro.excitation import Excitation
from floatsim.sea.spectra import Jonswap
from floatsim.sea.waves import IrregularWaves, RegularWave, WaveComponents

RHO, G, AREA, DRAUGHT = 1025.0, 9.81, 100.0, 15.0
COLUMNS = np.array([[-20.0, 0.0], [12.0, 18.0], [10.0, -20.0]])


def transfer(omega, heading):
    """X (6,) for e^{+i w t} and k = w^2/g, about the origin."""
    k = omega**2 / G
    direction = np.array([np.cos(heading), np.sin(heading)])
    out = np.zeros(6, complex)
    for x, y in COLUMNS:
        factor = np.exp(-1j * k * (direction @ [x, y]))
        heave = RHO * G * AREA * np.exp(-k * DRAUGHT) * factor
        fx, fy = 1j * RHO * omega**2 * AREA * DRAUGHT * factor * direction
        arm = -0.5 * DRAUGHT
        out += [fx, fy, heave, y * heave - arm * fy, arm * fx - x * heave, x * fy - y * fx]
    return out


def stiffness():
    """Waterplane terms: C33 = rho g S, C34 = rho g S y, C35 = -rho g S x, summed."""
    C = np.zeros((6, 6))
    for x, y in COLUMNS:
        row = RHO * G * AREA * np.array([1.0, y, -x])
        C[2, 2:5] += row
        C[3:5, 2] += row[1:]
    return C


def database(headings_deg=None, omega=None):
    omega = np.arange(1, 61) * 0.05 if omega is None else omega
    headings = np.radians(np.arange(-180.0, 180.0, 15.0) if headings_deg is None else headings_deg)
    X = np.array([[transfer(w, b) for b in headings] for w in omega])
    return SimpleNamespace(
        name="columns",
        omega=omega,
        headings=headings,
        excitation=X,
        hydrostatic_stiffness=stiffness(),
        reference_point=np.zeros((1, 3)),
    )


def scale():
    """Largest force and moment over the range, for tolerances."""
    X = np.abs(database().excitation).max(axis=(0, 1))
    return np.repeat([X[:3].max(), X[3:].max()], 3)


@pytest.mark.parametrize("heading_deg", [0.0, 7.0, 33.0, -101.0, 179.0, 541.0])
@pytest.mark.parametrize("period", [7.3, 11.0, 25.0, 60.0, 200.0])
def test_regular_wave_between_frequencies_and_headings(heading_deg, period):
    """60 s is between w = 0.10 and 0.15, 200 s below the lowest frequency."""
    sea = RegularWave(height=3.0, period=period, heading_deg=heading_deg, phase_deg=25.0).realise(np.inf, G)
    force = Excitation.from_database(database(), sea)
    omega = 2.0 * np.pi / period
    X = transfer(omega, np.radians(heading_deg))
    for t in (0.0, 3.1, 1234.5):
        exact = (X * 1.5 * np.exp(1j * (omega * t + np.radians(25.0)))).real
        assert np.abs((force.force(t) - exact) / scale()).max() < 1e-4


def test_long_waves_lift_like_sinking():
    """The limit is the hydrostatic stiffness of heave, with its moments."""
    sea = RegularWave(height=2.0, period=5000.0).realise(np.inf, G)
    force = Excitation.from_database(database(), sea).force(0.0)
    assert np.abs((force - stiffness()[:, 2]) / scale()).max() < 1e-4


def test_position_and_heading_of_the_drawing():
    """Moved and turned floater: the same columns seen from the moved and turned frame."""
    position, turn = (130.0, -45.0), np.radians(40.0)
    sea = RegularWave(height=2.0, period=9.0, heading_deg=75.0).realise(np.inf, G)
    omega, k = 2.0 * np.pi / 9.0, (2.0 * np.pi / 9.0) ** 2 / G
    along = position[0] * np.cos(np.radians(75.0)) + position[1] * np.sin(np.radians(75.0))
    exact = transfer(omega, np.radians(35.0)) * np.exp(-1j * k * along)
    moved = Excitation.from_database(database(), sea, position=position, heading=turn)
    assert np.abs((moved.coefficients[0] - exact) / scale()).max() < 1e-4


def test_reference_point_away_from_the_databases_origin():
    """Phases of a database refer to its origin; the position is that of the reference point."""
    sea = RegularWave(height=2.0, period=9.0, heading_deg=20.0).realise(np.inf, G)
    plain = Excitation.from_database(database(), sea, position=(50.0, 8.0), heading=0.5)
    shifted = database()
    shifted.reference_point = np.array([[4.0, -3.0, 0.0]])
    c, s = np.cos(0.5), np.sin(0.5)
    at = (50.0 + c * 4.0 + s * 3.0, 8.0 + s * 4.0 - c * 3.0)
    same = Excitation.from_database(shifted, sea, position=at, heading=0.5)
    assert np.abs((same.coefficients - plain.coefficients) / scale()).max() < 1e-12


def test_irregular_sea_is_the_sum_of_its_waves():
    sea = IrregularWaves(spectrum=Jonswap(hs=4.0, tp=10.0), seed=8, heading_deg=-22.0).realise(np.inf, G)
    force = Excitation.from_database(database(np.arange(-180.0, 180.0, 5.0)), sea)
    X = np.array([transfer(w, np.radians(-22.0)) for w in sea.omega])
    t = 817.3
    exact = (X * (sea.amplitude * np.exp(1j * (sea.omega * t + sea.phase)))[:, None]).real.sum(axis=0)
    assert np.abs((force.force(t) - exact) / scale()).max() < 1e-4
    assert force.left_out == 0.0


def test_each_wave_has_its_own_heading():
    waves = {"amplitude": (1.0, 0.7), "omega": (0.6, 0.8)}
    both = WaveComponents(**waves, heading_deg=(10.0, -70.0)).realise(np.inf, G)
    X = np.array([transfer(0.6, np.radians(10.0)), 0.7 * transfer(0.8, np.radians(-70.0))])
    assert np.abs((Excitation.from_database(database(), both).coefficients - X) / scale()).max() < 1e-4


def test_ramp():
    sea = RegularWave(height=2.0, period=9.0).realise(np.inf, G)
    plain = Excitation.from_database(database(), sea)
    ramped = Excitation.from_database(database(), sea, ramp=80.0)
    assert ramped.force(20.0) == pytest.approx(plain.force(20.0) * (0.5 - np.sqrt(0.125)))
    assert ramped.force(0.0) == pytest.approx(np.zeros(6))
    assert (ramped.force(81.0) == plain.force(81.0)).all()


@pytest.mark.parametrize("count", [24, 25])
def test_even_and_odd_numbers_of_headings(count):
    sea = RegularWave(height=2.0, period=10.0, heading_deg=51.0).realise(np.inf, G)
    db = database(headings_deg=-180.0 + 360.0 / count * np.arange(count))
    exact = transfer(2.0 * np.pi / 10.0, np.radians(51.0))
    assert np.abs((Excitation.from_database(db, sea).coefficients[0] - exact) / scale()).max() < 1e-4


def test_headings_along_the_databases_need_no_circle():
    sea = RegularWave(height=2.0, period=10.0, heading_deg=40.0).realise(np.inf, G)
    db = database(headings_deg=[0.0, 10.0])
    force = Excitation.from_database(db, sea, heading=np.radians(30.0))
    exact = transfer(2.0 * np.pi / 10.0, np.radians(10.0))
    assert np.abs((force.coefficients[0] - exact) / scale()).max() < 1e-4


@pytest.mark.parametrize(
    ("headings_deg", "message"),
    [
        ([0.0], r"a wave at 5 deg .* it has only 0 deg"),
        (np.arange(-180.0, 90.0, 30.0), r"missing are 90, 120, 150 deg"),
        ([-120.0, 0.0], r"missing are 120 deg"),
        ([-180.0, -170.0, 3.0], r"not multiples of one step"),
    ],
)
def test_missing_headings_are_listed(headings_deg, message):
    sea = RegularWave(height=2.0, period=10.0, heading_deg=5.0).realise(np.inf, G)
    with pytest.raises(ModelError, match="'columns'.*" + message):
        Excitation.from_database(database(headings_deg), sea)


def test_headings_too_coarse_for_short_waves():
    """The harmonics needed are about k R: 0.8 at 20 s, 12 at 5 s, and eight headings know up to the fourth."""
    db = database(headings_deg=np.arange(-180.0, 180.0, 45.0))
    long = RegularWave(height=2.0, period=20.0, heading_deg=20.0).realise(np.inf, G)
    exact = transfer(2.0 * np.pi / 20.0, np.radians(20.0))
    assert np.abs((Excitation.from_database(db, long).coefficients[0] - exact) / scale()).max() < 1e-3
    short = RegularWave(height=2.0, period=5.0, heading_deg=20.0).realise(np.inf, G)
    with pytest.raises(ModelError, match="45 deg apart, are too coarse"):
        Excitation.from_database(db, short)


def test_energy_above_the_database_is_refused_and_a_trace_of_it_left_out():
    db = database(omega=np.arange(1, 31) * 0.05)
    steep = IrregularWaves(spectrum=Jonswap(hs=2.0, tp=6.0), seed=1).realise(np.inf, G)
    with pytest.raises(ModelError, match=r"'columns': its frequencies 0.05 to 1.5 rad/s .* reaches .* omega_max"):
        Excitation.from_database(db, steep)
    mild = WaveComponents(amplitude=(1.0, 0.05), omega=(0.5, 1.7)).realise(np.inf, G)
    force = Excitation.from_database(db, mild)
    assert force.left_out == pytest.approx(0.0025 / 1.0025)
    assert not force.coefficients[1].any()
    cut = IrregularWaves(spectrum=Jonswap(hs=2.0, tp=6.0), seed=1, omega_max=1.5).realise(np.inf, G)
    assert Excitation.from_database(db, cut).left_out == 0.0
