"""Databases computed by Capytaine: symmetry, refusals, and (where it is installed) small runs."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from floatsim.errors import ModelError
from floatsim.hydro import compute
from floatsim.hydro.compute import Symmetry, WetBody, compute_database, write_checked
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import boxes, graded, hydrostatics, images, planes, rectangle, revolve

HEADINGS = np.radians(np.arange(-180.0, 180.0, 30.0))


def ball(depth=0.0, around=12, one=True, rings=6):
    theta = (0.5 if depth == 0.0 else 1.0) * np.pi * np.arange(rings + 1) / rings
    hull = np.column_stack([np.sin(theta), -np.cos(theta) - depth])
    lid = np.column_stack([np.linspace(0.0, 1.0, 4), np.full(4, -0.05)])
    return WetBody("ball", revolve(hull, around, 1 if one else None), (0.0, 0.0, 0.0),
                   revolve(lid, around, 1 if one else None) if depth == 0.0 else None)  # fmt: skip


def test_headings_that_are_images_are_solved_once():
    orbits = compute._orbits(HEADINGS, Symmetry(turns=12).operations())
    assert len({k for k, _ in orbits}) == 1
    assert HEADINGS[orbits[0][0]] == pytest.approx(0.0)
    orbits = compute._orbits(HEADINGS, Symmetry(("xOz", "yOz")).operations())
    assert len({k for k, _ in orbits}) == 4  # 0, 30, 60, 90 deg
    for k, (j, q) in enumerate(orbits):
        turned = q @ [math.cos(HEADINGS[j]), math.sin(HEADINGS[j]), 0.0]
        np.testing.assert_allclose(turned[:2], [math.cos(HEADINGS[k]), math.sin(HEADINGS[k])], atol=1e-12)


def test_forces_of_mirrored_and_turned_waves():
    force = np.arange(1.0, 13.0) + 0j  # two bodies
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])  # of a wave mirrored at xOz
    np.testing.assert_allclose(compute._image(force, np.diag([1.0, -1.0, 1.0])), force * np.tile(mirror, 2))
    quarter = Symmetry(turns=4).operations()[1]
    np.testing.assert_allclose(compute._image(force[:6], quarter), [-2.0, 1.0, 3.0, -5.0, 4.0, 6.0], atol=1e-12)


def test_headings_of_a_body_with_three_arms():
    """Three small columns that feel the local wave: F = (cos b, sin b, i) e^{-i k.x}, M = x cross F."""
    k, columns = 0.12, np.array([[-51.75, 0.0, -3.0], [25.875, 44.81682, -3.0], [25.875, -44.81682, -3.0]])

    def force(heading):
        towards = np.array([math.cos(heading), math.sin(heading), 0.0])
        total = np.zeros(6, dtype=complex)
        for x in columns:
            f = (towards + np.array([0.0, 0.0, 1j])) * np.exp(-1j * k * (x @ towards))
            total += np.concatenate([f, np.cross(x, f)])
        return total

    headings = np.radians(np.arange(-180.0, 180.0, 5.0))
    orbits = compute._orbits(headings, Symmetry(("xOz",), 3).operations())
    assert len({j for j, _ in orbits}) == 13
    found = np.array([compute._image(force(headings[j]), q) for j, q in orbits])
    exact = np.array([force(heading) for heading in headings])
    np.testing.assert_allclose(found, exact, atol=1e-6 * np.abs(exact).max())


def test_negative_damping_is_clipped_and_told():
    damping = np.tile(np.diag([1.0, 1.0, 2.0, 1.0, 1.0, 1.0]), (2, 1, 1))
    damping[1, 0, 0] = -0.25
    kept, size = compute._positive(damping, np.ones(6))
    assert size == pytest.approx(0.25)
    np.testing.assert_array_equal(kept[0], damping[0])
    assert kept[1, 0, 0] == pytest.approx(0.0, abs=1e-15) and kept[1, 2, 2] == pytest.approx(2.0)


def test_without_capytaine_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "capytaine", None)
    with pytest.raises(ModelError, match="'bem'"):
        compute_database("ball", [ball()], [1.0, 2.0], depth=math.inf)


@pytest.mark.parametrize(("changes", "message"), [
    ({"omega": [1.0]}, "at least two"),
    ({"omega": [2.0, 1.0]}, "increasing"),
    ({"omega": [0.1, 1.0], "depth": 4.0}, "0.145"),
    ({"bodies": [ball(one=False), ball(one=False)]}, "name of its own"),
    ({"bodies": [ball(one=False)._replace(hull=ball().hull)]}, "free"),
])  # fmt: skip
def test_refusals(monkeypatch, changes, message):
    monkeypatch.setattr(compute, "load_capytaine", lambda: None)  # refused before it is needed
    arguments = {"name": "ball", "bodies": [ball(one=False)], "omega": [1.0, 2.0], "depth": math.inf} | changes
    with pytest.raises(ModelError, match=message):
        compute_database(**arguments)


def test_a_body_on_the_seabed_must_bring_its_hydrostatics(monkeypatch):
    monkeypatch.setattr(compute, "load_capytaine", lambda: None)
    lines = tuple(planes(v, 0.5) for v in ((0.0, 1.0), (0.0, 1.0), (-5.0, -4.0)))
    (mesh,) = boxes([[((0.0, 1.0), (0.0, 1.0), (-5.0, -4.0))]], lines)
    standing = mesh._replace(faces=mesh.faces[mesh.vertices[mesh.faces, 2].max(axis=1) > -4.9])
    with pytest.raises(ModelError, match="stands on the seabed"):
        compute_database("block", [WetBody("block", standing, (0.5, 0.5, -4.5))], [2.0, 3.0], depth=5.0)


def test_inconsistent_databases_are_not_written(tmp_path, capsys):
    n = 4
    B = np.tile(np.eye(6), (n, 1, 1))
    B[1] *= -1.0
    db = HydroDatabase(
        name="bad", omega=np.arange(1.0, n + 1), added_mass=np.tile(np.eye(6), (n, 1, 1)), radiation_damping=B,
        added_mass_inf=np.eye(6), headings=np.zeros(1), excitation=np.zeros((n, 1, 6), complex),
        hydrostatic_stiffness=np.eye(6), volume=1.0, centre_of_buoyancy=np.zeros(3), reference_point=np.zeros(3),
        depth=10.0, density=1000.0, gravity=9.81,
    )  # fmt: skip
    with pytest.raises(ModelError, match="not written"):
        write_checked(db, tmp_path / "bad.nc")
    assert not (tmp_path / "bad.nc").exists() and "error" in capsys.readouterr().out


# --- with Capytaine ---------------------------------------------------------------------------------


def test_symmetry_changes_nothing():
    pytest.importorskip("capytaine")
    omega = [1.0, 3.0]
    whole = compute_database("ball", [ball(one=False)], omega, HEADINGS, depth=math.inf)
    sector = compute_database("ball", [ball()], omega, HEADINGS, depth=math.inf, symmetry=Symmetry(turns=12))
    for name in ("added_mass", "radiation_damping", "added_mass_inf", "added_mass_zero", "excitation", "froude_krylov"):
        a, b = getattr(whole, name), getattr(sector, name)
        np.testing.assert_allclose(a, b, atol=1e-4 * np.abs(a).max(), err_msg=name)
    assert sector.source["headings_solved"] == 1 and whole.source["headings_solved"] == HEADINGS.size


def test_quarter_of_a_barge_is_the_barge():
    pytest.importorskip("capytaine")
    x, y, z = graded(0.0, 2.0, 0.7), graded(0.0, 1.0, 0.5), graded(-1.0, 0.0, 0.5)
    (part,) = boxes([[((0.0, 2.0), (0.0, 1.0), (-1.0, 0.0))]], (x, y, z))
    wall = np.minimum(*(np.abs(part.vertices[part.faces, k]).max(axis=1) for k in (0, 1))) < 1e-9
    hull, lid = part._replace(faces=part.faces[~wall]), rectangle(x, y, -0.1)
    symmetry = Symmetry(("xOz", "yOz"))
    point = (0.0, 0.0, -0.4)
    quarter = compute_database("barge", [WetBody("barge", hull, point, lid)], [1.5, 3.0], HEADINGS, depth=6.0,
                               symmetry=symmetry)  # fmt: skip
    full = WetBody("barge", images(hull, symmetry.operations()), point, images(lid, symmetry.operations()))
    whole = compute_database("barge", [full], [1.5, 3.0], HEADINGS, depth=6.0)
    for name in ("added_mass", "radiation_damping", "added_mass_inf", "excitation", "froude_krylov"):
        a, b = getattr(whole, name), getattr(quarter, name)
        rough = 5e-3 if name == "added_mass_inf" else 1e-4  # Capytaine 3.0's Green function at infinity in finite depth
        np.testing.assert_allclose(a, b, atol=rough * np.abs(a).max(), err_msg=name)
    assert hydrostatics(full.hull, point).volume == pytest.approx(float(quarter.volume[0]))


def test_bodies_far_apart_do_not_feel_each_other_and_near_ones_do():
    pytest.importorskip("capytaine")

    def pair(distance):
        sub = ball(depth=1.5, one=False, rings=8, around=10)
        bodies = [sub._replace(name=name, hull=sub.hull._replace(vertices=sub.hull.vertices + (x, 0.0, 0.0)),
                               reference_point=(x, 0.0, -1.5))
                  for name, x in (("left", -0.5 * distance), ("right", 0.5 * distance))]  # fmt: skip
        return compute_database("pair", bodies, [1.0, 2.0], depth=math.inf, density=1000.0)

    near, far = pair(2.2), pair(60.0)
    scale = far.added_mass_inf[0, 0]
    assert np.abs(far.added_mass_inf[:6, 6:]).max() < 1e-3 * scale < np.abs(near.added_mass_inf[:6, 6:]).max()
    displaced = 1000.0 * 4.0 / 3.0 * math.pi
    assert scale / displaced == pytest.approx(0.5, rel=0.15)  # of a sphere in unbounded water
    assert near.bodies == ("left", "right") and near.hull_body is not None and near.hull_body.max() == 1


def test_long_waves_and_froude_krylov_of_a_small_ball():
    pytest.importorskip("capytaine")
    db = compute_database("ball", [ball(rings=10, around=20)], [0.4, 0.5], [0.0], depth=math.inf, density=1000.0,
                          symmetry=Symmetry(turns=20))  # fmt: skip
    k = 0.4**2 / 9.81
    # surge: (1 + C) rho V times the acceleration i w^2 of the water at the centre (Newman 1977), C = A11 / (rho V)
    mass = 1000.0 * 2.0 / 3.0 * math.pi
    assert db.froude_krylov[0, 0, 0] == pytest.approx(1j * 9.81 * k * mass, rel=0.03)
    assert db.excitation[0, 0, 0] == pytest.approx(1j * 9.81 * k * (mass + db.added_mass[0, 0, 0]), rel=0.05)
    assert db.excitation[0, 0, 2].real == pytest.approx(1000.0 * 9.81 * math.pi, rel=0.1)
    assert db.added_mass_zero[2, 2] / mass == pytest.approx(0.8310, rel=0.03)  # Hulme 1982, ka = 0
