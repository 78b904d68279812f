"""WAMIT's .1, .3 and .hst: scaling, special periods, headings, signs, and messages for bad files.

All files are written here; expected numbers follow from the scaling in the WAMIT User Manual v7, 3.1 and 5.2.
"""

from __future__ import annotations

import gzip
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from floatsim.errors import ModelError
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.wamit import read_wamit

RHO, G, ULEN = 1000.0, 10.0, 2.0

RADIATION = """\
 -1.0000E+00     1     1   3.0
  0.0000E+00     1     1   1.0
  0.0000E+00     1     5  -0.5
  0.0000E+00     5     5   4.0
  1.0000E+01     1     1   2.0   0.3
  1.0000E+01     1     5  -1.5   0.2
  1.0000E+01     5     5   5.0   0.1
  5.0000E+00     1     1   1.2   0.7
"""
EXCITATION = """\
  1.0000E+01  0.0000E+00     1   2.0    9.000000E+01   0.0   2.0
  1.0000E+01  0.0000E+00     3   7.0    0.000000E+00   7.0   0.0
  1.0000E+01  0.0000E+00     5   5.0   -3.686990E+01   4.0  -3.0
  1.0000E+01  1.8000E+02     1   2.0   -9.000000E+01   0.0  -2.0
  5.0000E+00  0.0000E+00     1   1.0    0.000000E+00   1.0   0.0
  5.0000E+00  1.8000E+02     1   1.0    0.000000E+00   1.0   0.0
"""
HYDROSTATICS = """\
     3     3   1.5
     3     5   0.25
     5     3   0.25
     4     4   2.0
     5     5   3.0
     4     6   0.5
"""


def write(
    folder: Path, radiation: str = RADIATION, excitation: str = EXCITATION, statics: str = HYDROSTATICS
) -> Path:
    stem = folder / "hull.v2"  # a point in the name must not be taken for an ending
    for ending, text in ((".1", radiation), (".3", excitation), (".hst", statics)):
        Path(f"{stem}{ending}").write_text(text)
    return stem


def read(stem: Path, **changes: Any) -> HydroDatabase:
    arguments: dict[str, Any] = {
        "volume": 50.0,
        "centre_of_buoyancy": (0.0, 0.0, -1.0),
        "depth": 30.0,
        "density": RHO,
        "gravity": G,
        "length": ULEN,
    }
    return read_wamit(stem, **(arguments | changes))


def test_dimensions(tmp_path: Path) -> None:
    db = read(write(tmp_path), reference_point=(1.0, 0.0, -2.0))
    w = np.array([2.0 * math.pi / 10.0, 2.0 * math.pi / 5.0])
    assert db.omega == pytest.approx(w)  # increasing, although periods may come in any order
    # A rho L^3, L^4, L^5
    assert db.added_mass[0, 0, 0] == pytest.approx(2.0 * 1000.0 * 8.0)
    assert db.added_mass[0, 0, 4] == pytest.approx(-1.5 * 1000.0 * 16.0)
    assert db.added_mass[0, 4, 4] == pytest.approx(5.0 * 1000.0 * 32.0)
    assert db.added_mass[0, 4, 0] == 0.0  # not in the file
    # B rho w L^3, L^4
    assert db.radiation_damping[:, 0, 0] == pytest.approx([0.3 * 8e3 * w[0], 0.7 * 8e3 * w[1]])
    assert db.radiation_damping[0, 0, 4] == pytest.approx(0.2 * 16e3 * w[0])
    # X rho g L^2, L^3
    ahead = int(np.argmin(np.abs(db.headings)))
    assert db.excitation[0, ahead, 2] == pytest.approx(7.0 * 1000.0 * 10.0 * 4.0)
    assert db.excitation[0, ahead, 4] == pytest.approx((4.0 - 3.0j) * 1000.0 * 10.0 * 8.0)
    # C rho g L^2, L^3, L^4
    assert db.hydrostatic_stiffness[2, 2] == pytest.approx(1.5 * 10e3 * 4.0)
    assert db.hydrostatic_stiffness[2, 4] == pytest.approx(0.25 * 10e3 * 8.0)
    assert db.hydrostatic_stiffness[4, 4] == pytest.approx(3.0 * 10e3 * 16.0)
    assert db.hydrostatic_stiffness[3, 5] == pytest.approx(0.5 * 10e3 * 16.0)
    assert (db.name, db.volume, db.depth, db.density, db.gravity) == ("hull.v2", 50.0, 30.0, RHO, G)
    assert db.centre_of_buoyancy.tolist() == [[0.0, 0.0, -1.0]]
    assert db.reference_point.tolist() == [[1.0, 0.0, -2.0]]


def test_special_periods(tmp_path: Path) -> None:
    """PER = 0 is infinite frequency, PER < 0 zero frequency."""
    db = read(write(tmp_path))
    assert db.added_mass_inf[0, 0] == pytest.approx(1.0 * 8e3)
    assert db.added_mass_inf[4, 4] == pytest.approx(4.0 * 32e3)
    assert db.added_mass_zero is not None
    assert db.added_mass_zero[0, 0] == pytest.approx(3.0 * 8e3)
    without = "\n".join(line for line in RADIATION.splitlines() if not line.startswith(" -1"))
    assert read(write(tmp_path, radiation=without)).added_mass_zero is None


def test_headings_are_wrapped_once(tmp_path: Path) -> None:
    """180 degrees is -180 degrees; a file with both ends of the circle has one wave twice."""
    both = EXCITATION + EXCITATION.replace("  1.8000E+02", " -1.8000E+02").replace(
        " 0.0000E+00     ", " 3.6000E+02     "
    )
    for text in (EXCITATION, both):
        db = read(write(tmp_path, excitation=text))
        assert np.degrees(db.headings) == pytest.approx([-180.0, 0.0])
        assert db.excitation.shape == (2, 2, 6)
        assert db.excitation[0, 0, 0] == pytest.approx(-2j * 40e3)


def test_sign_convention(tmp_path: Path) -> None:
    """A small body in a long wave, as WAMIT would print it, pushes with du/dt and lifts with the crest.

    WAMIT's incident potential i g a / w e^{k z - i k x} e^{i w t} gives u = w a e^{i w t} and
    du/dt = i w^2 a at the surface, so that X1 = rho V (1 + Ca) i w^2 and X3 = rho g A_wp > 0. What is read
    must push so in the time domain, with floatsim's wave.
    """
    period, area, volume, ca = 20.0, 4.0, 6.0, 0.5
    w = 2.0 * math.pi / period
    surge = volume * (1.0 + ca) * w * w / G / ULEN**2
    heave = area / ULEN**2
    lines = []
    for heading, sign in ((0.0, 1.0), (180.0, -1.0)):
        lines.append(f"{period} {heading} 1 {surge} {sign * 90.0} 0.0 {sign * surge}")
        lines.append(f"{period} {heading} 3 {heave} 0.0 {heave} 0.0")
    text = "\n".join(lines + [line.replace("20.0", "10.0", 1) for line in lines])
    radiation = "0 1 1 1.0\n20.0 1 1 1.0 0.1\n10.0 1 1 1.0 0.1\n"
    db = read(write(tmp_path, radiation=radiation, excitation=text))

    amplitude, phase, k = 0.7, 0.4, w * w / G
    t = np.linspace(0.0, period, 201)
    for heading in (0.0, -math.pi):
        towards = math.cos(heading)

        def elevation(x: float, t: np.ndarray, towards: float = towards) -> np.ndarray:
            return amplitude * np.cos(w * t - k * x * towards + phase)

        x3 = db.excitation[0, int(np.argmin(np.abs(db.headings - heading)))]
        force = np.real(x3[:, None] * amplitude * np.exp(1j * (w * t + phase)))
        # linear Euler equation at the surface: du/dt = -g d(eta)/dx
        slope = (elevation(1e-3, t) - elevation(-1e-3, t)) / 2e-3
        np.testing.assert_allclose(
            force[0], RHO * volume * (1.0 + ca) * -G * slope, atol=1e-5 * np.abs(force[0]).max()
        )
        np.testing.assert_allclose(force[2], RHO * G * area * elevation(0.0, t), rtol=1e-9, atol=1e-6)


def test_weight_is_taken_out_of_the_stiffness(tmp_path: Path) -> None:
    """WAMIT: C44 = ... - m g z_G, C46 = ... + m g x_G, C56 = ... + m g y_G with m = rho V."""
    plain = read(write(tmp_path)).hydrostatic_stiffness
    weighed = read(write(tmp_path), centre_of_gravity=(0.3, 0.1, -2.0)).hydrostatic_stiffness
    weight = RHO * G * 50.0
    expected = np.zeros((6, 6))
    expected[3, 3] = expected[4, 4] = -2.0 * weight
    expected[3, 5], expected[4, 5] = -0.3 * weight, -0.1 * weight
    np.testing.assert_allclose(weighed - plain, expected, atol=1e-6)


def test_gzip_header_and_fortran_exponents(tmp_path: Path) -> None:
    stem = write(tmp_path, radiation="PER I J ABAR BBAR\n" + RADIATION.replace("E+", "D+"))
    plain = read(stem)
    for ending in (".1", ".3", ".hst"):
        path = Path(f"{stem}{ending}")
        with gzip.open(f"{path}.gz", "wt") as file:
            file.write(path.read_text())
        path.unlink()
    packed = read(stem)
    assert np.array_equal(plain.added_mass, packed.added_mass)
    assert np.array_equal(plain.excitation, packed.excitation)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (
            {"radiation": RADIATION.replace("0.2\n", "oops\n")},
            r"hull\.v2\.1, line 6: not numbers: '1\.0000E\+01 .* oops'",
        ),
        ({"radiation": RADIATION.replace("  -1.5   0.2", "  -1.5")}, r"\.1, line 6: 4 numbers, must be 5"),
        ({"radiation": RADIATION + "5.0 1 1\n"}, r"\.1, line 9: 3 numbers, must be 4 or 5"),
        ({"radiation": RADIATION + "5.0 7 1 1.0 1.0\n"}, r"\.1, line 9: degree of freedom 7, must be 1 to 6"),
        ({"radiation": RADIATION + "5.0 1 1 1.0 1.0\n"}, r"\.1, line 9: this entry was given before"),
        ({"radiation": RADIATION + "5.0 3 3 nan 1.0\n"}, r"\.1, line 9: .* is not finite"),
        (
            {"radiation": RADIATION.replace("  0.0000E+00 ", "  2.0000E+00 ").replace("-0.5", "1 1")},
            r"\.1, line 2: 4 num",
        ),
        ({"radiation": "10.0 1 1 1.0 0.1\n5.0 1 1 1.0 0.1\n"}, r"\.1: no added mass at infinite frequency"),
        ({"radiation": "0 1 1 1.0\n5.0 1 1 1.0 0.1\n"}, r"\.1: 1 finite periods, at least two"),
        ({"excitation": EXCITATION + "5.0 90.0 3 1.0 0.0 1.0\n"}, r"\.3, line 7: 6 numbers, must be 7"),
        (
            {"excitation": EXCITATION + "0.0 0.0 3 1.0 0.0 1.0 0.0\n"},
            r"\.3, line 7: period 0 s, must be positive",
        ),
        (
            {"excitation": EXCITATION + "5.0 90.0 3 1.0 0.0 1.0 0.0\n"},
            r"\.3: 1 comb.* period 10 s, heading 90 deg",
        ),
        (
            {"excitation": EXCITATION.replace("5.0000", "4.0000")},
            r"\.3: its 2 periods are not the 2 finite ones",
        ),
        ({"statics": HYDROSTATICS + "3 0 1.0\n"}, r"\.hst, line 7: degree of freedom 0"),
        ({"statics": ""}, r"\.hst: is empty"),
    ],
)
def test_bad_files(tmp_path: Path, files: dict[str, str], message: str) -> None:
    with pytest.raises(ModelError, match=message) as caught:
        read(write(tmp_path, **files))
    assert len(caught.value.problems) == 1


def test_missing_and_unreadable_files(tmp_path: Path) -> None:
    stem = write(tmp_path)
    with pytest.raises(ModelError, match=r"nobody\.1' does not exist"):
        read(tmp_path / "nobody")
    Path(f"{stem}.3").unlink()
    Path(f"{stem}.3.gz").write_bytes(b"not gzip")
    with pytest.raises(ModelError, match=r"\.3\.gz: cannot be read"):
        read(stem)
