"""Physical checks that need a floater whose waves are known: energy, long waves, single frequencies, shared walls.

The floater is axisymmetric and obeys exactly: |X3| falls from the waterplane's stiffness, damping follows from the
energy of the waves that excite it (Newman, Marine Hydrodynamics, 1977), added mass from damping (Ogilvie 1964) by an
integral that is done here with SciPy.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from floatsim.hydro.check import Finding, check_database
from floatsim.hydro.conventions import ESTIMATED
from floatsim.hydro.database import HydroDatabase

RHO, G, VOLUME, AREA, FADE = 1000.0, 9.81, 260.0, 78.0, 0.55  # a sphere of 5 m, half submerged; FADE in s2
STIFFNESS = RHO * G * AREA
AT = (20.0, -10.0)  # off the origin: phases matter


def heave(w: float) -> float:
    """|X3|, N/m: rho g A_wp in long waves."""
    return STIFFNESS * math.exp(-FADE * w * w)


def damping(w: float) -> float:
    """B33 of an axisymmetric body in deep water: k |X|^2 / (4 rho g c_g) with k = w^2/g, c_g = g/(2 w)."""
    return w**3 / (2.0 * RHO * G**3) * heave(w) ** 2


@lru_cache
def added_mass(w: float) -> float:
    """A(w) - A_inf = 2/pi P int B(s)/(s^2 - w^2) ds; its integrand is B(s)/(s + w) over (s - w)."""
    near = quad(lambda s: damping(s) / (s + w), 0.0, 2.0 * w, weight="cauchy", wvar=w)[0]
    far = quad(lambda s: damping(s) / (s * s - w * w), 2.0 * w, 12.0)[0]
    return 2.0 / math.pi * (near + far)


def floater(headings: np.ndarray | None = None, **changes: Any) -> HydroDatabase:
    omega = 0.05 * np.arange(1, 61)
    headings = np.radians(np.arange(-180.0, 180.0, 10.0)) if headings is None else headings
    k = omega**2 / G
    lag = np.exp(-1j * k[:, None] * (AT[0] * np.cos(headings) + AT[1] * np.sin(headings)))
    A_inf = np.diag([0.3, 0.3, 0.5, 2.0, 2.0, 0.1]) * RHO * VOLUME
    A, B = np.tile(A_inf, (60, 1, 1)), np.zeros((60, 6, 6))
    A[:, 2, 2] += [added_mass(w) for w in omega]
    B[:, 2, 2] = [damping(w) for w in omega]
    X = np.zeros((60, headings.size, 6), dtype=complex)
    X[:, :, 2] = np.array([heave(w) for w in omega])[:, None] * lag
    push = RHO * VOLUME * 1.3 * omega**2 * np.exp(-3.0 * omega**4)
    X[:, :, 0], X[:, :, 1] = (1j * push[:, None] * lag * along for along in (np.cos(headings), np.sin(headings)))
    for i in (0, 1):  # int cos^2 = pi
        B[:, i, i] = omega**3 / (4.0 * RHO * G**3) * push**2
    arguments: dict[str, Any] = {
        "name": "sphere", "omega": omega, "added_mass": A, "radiation_damping": B, "added_mass_inf": A_inf,
        "headings": headings, "excitation": X, "hydrostatic_stiffness": np.diag([0, 0, STIFFNESS, 1e6, 1e6, 0]),
        "volume": VOLUME, "centre_of_buoyancy": [*AT, -1.9], "reference_point": [*AT, 0.0], "depth": math.inf,
        "density": RHO, "gravity": G,
    }  # fmt: skip
    return HydroDatabase(**(arguments | changes))


def found(db: HydroDatabase) -> dict[str, Finding]:
    return {finding.quantity: finding for finding in check_database(db)}


def bad(db: HydroDatabase) -> set[str]:
    return {name for name, finding in found(db).items() if finding.severity == "error"}


SURGE, ENERGY, SPIKE = "long-wave surge and sway excitation", "radiated energy", "irregular frequencies"


def test_nothing_is_wrong_with_a_floater_that_obeys() -> None:
    findings = found(floater())
    assert {finding.severity for finding in findings.values()} == {"ok"}, findings
    assert findings[ENERGY].measured < 1e-6
    assert findings[SURGE].measured < 0.01  # e^{k z} and the fade at 0.05 rad/s
    assert findings["added mass at infinite frequency"].measured < 0.01


def test_wrong_signs_and_origins_are_found() -> None:
    db = floater()
    X = db.excitation
    assert SURGE in bad(replace(db, excitation=X.conj()))  # the other time factor
    turned = np.roll(X, X.shape[1] // 2, axis=1)  # headings from which waves come
    assert SURGE in bad(replace(db, excitation=turned))
    assert SURGE in bad(replace(db, excitation=X / 9.81)) and ENERGY in bad(replace(db, excitation=X / 9.81))
    about = found(replace(db, excitation=X * np.exp(-1j), name="late"))[SURGE]
    assert "it is 1 times what the water's acceleration gives, -57.3 deg away in phase; check" in about.message
    # of a body a wavelength away, phases must be those of its place
    far = replace(db, centre_of_buoyancy=[[4000.0, 0.0, -1.9]])
    assert SURGE in bad(far)


def test_wrong_depth_is_found() -> None:
    """Long waves in 10 m are far longer than deep water's: the force of the same wave frequency is another."""
    assert SURGE in bad(replace(floater(), depth=10.0))


def test_energy() -> None:
    db = floater()
    B = db.radiation_damping.copy()
    B[:, 2, 2] *= 1.15
    assert found(replace(db, radiation_damping=B))[ENERGY].severity == "warning"
    B[:, 2, 2] *= 2.0
    finding = found(replace(db, radiation_damping=B))[ENERGY]
    assert finding.severity == "error" and finding.measured == pytest.approx(1.3 / 2.3, rel=0.02)
    assert "heave damping is" in finding.message
    one = floater(headings=np.array([0.0]))
    assert found(one)[ENERGY].message.startswith("not looked at: headings further apart than 20 deg")
    assert found(one)["heading step"].message.startswith("only heading 0 deg is there: waves of any other will be")


def test_single_frequencies_stand_out() -> None:
    db = floater()
    for name in ("added_mass", "radiation_damping"):
        values = getattr(db, name).copy()
        values[25, 2, 2] += 0.1 * values[:, 2, 2].max()
        finding = found(replace(db, **{name: values}))[SPIKE]
        assert finding.severity == "warning" and finding.measured == pytest.approx(0.1, rel=0.2)
        assert "heave" in finding.message and "at 1.3 rad/s; an irregular frequency (mesh" in finding.message


def test_a_resonance_of_the_water_is_none() -> None:
    """A narrow peak over three or four frequencies, as between the columns of a platform, is no defect."""
    db = floater()
    B = db.radiation_damping.copy()
    width = 0.06
    B[:, 2, 2] += 0.5 * B[:, 2, 2].max() * width**2 / ((db.omega - 1.01) ** 2 + width**2)
    assert found(replace(db, radiation_damping=B))[SPIKE].severity == "ok"


def test_froude_krylov() -> None:
    db = floater()
    part = db.excitation / np.array([1.3, 1.3, 1.0, 1.0, 1.0, 1.0])  # rho V without the added mass
    name = "long-wave Froude-Krylov force"
    assert found(replace(db, froude_krylov=part))[name].severity == "ok"
    for wrong, what in (
        (db.excitation, "the displaced water gives along the wave"),
        (part.conj(), "the displaced water gives along the wave"),
        (part * [1, 1, 1.4, 1, 1, 1], "the waterplane gives in heave"),
    ):
        finding = found(replace(db, froude_krylov=wrong))[name]
        assert finding.severity == "error" and what in finding.message


def test_an_estimate_is_said_to_be_one() -> None:
    finding = found(replace(floater(), source={"added_mass_inf": ESTIMATED}))["added mass at infinite frequency"]
    assert finding.severity == "warning" and finding.message.startswith("A_inf was not computed but taken from A(w)")


def test_walls_that_bodies_share() -> None:
    """A ring around a spar whose common walls were left out: each is pushed wrongly, both together rightly."""
    one = floater()
    twice = np.eye(2)
    db = replace(
        one, name="pair", bodies=("ring", "spar"), added_mass=np.kron(twice, one.added_mass),
        radiation_damping=np.kron(twice, one.radiation_damping), added_mass_inf=np.kron(twice, one.added_mass_inf),
        excitation=np.tile(one.excitation, (1, 1, 2)), volume=np.tile(one.volume, 2),
        hydrostatic_stiffness=np.kron(twice, one.hydrostatic_stiffness),
        centre_of_buoyancy=np.tile(one.centre_of_buoyancy, (2, 1)),
        reference_point=np.tile(one.reference_point, (2, 1)),
    )  # fmt: skip
    assert found(db)[f"{SURGE} of ring"].severity == "ok"
    shift = 0.5 * db.excitation[:, :, :2]
    X = db.excitation.copy()
    X[:, :, :2] += shift
    X[:, :, 6:8] -= shift
    finding = found(replace(db, excitation=X))[f"{SURGE} of ring"]
    assert finding.severity == "warning" and "walls that bodies share were left out" in finding.message
    X[:, :, 6:8] += shift
    assert f"{SURGE} of ring" in bad(replace(db, excitation=X))
