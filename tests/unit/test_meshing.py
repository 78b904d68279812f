"""Panel meshes: what they enclose, and what is found wrong with them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from floatsim.hydro.compute import Symmetry
from floatsim.hydro.meshing import (
    Mesh,
    boxes,
    graded,
    hydrostatics,
    images,
    join,
    lid,
    mesh_hash,
    mesh_problems,
    planes,
    profile,
    rectangle,
    revolve,
    to_waterline,
    wetted,
)

BOX = ((-0.5, 1.5), (-2.0, 1.0), (-1.2, 0.0))


def box_mesh(*bodies):
    lines = tuple(planes((v for body in bodies for box in body for v in box[k]), 0.4) for k in range(3))
    return boxes(bodies, lines)


def hemisphere(rings=40, around=48):
    theta = 0.5 * np.pi * np.arange(rings + 1) / rings
    return revolve(2.0 * np.column_stack([np.sin(theta), -np.cos(theta)]), around)


def test_box_beside_the_origin_has_exact_hydrostatics():
    (mesh,) = box_mesh([BOX])
    point = np.array([0.2, -0.3, -0.7])
    h = hydrostatics(mesh, point)
    area, volume = 2.0 * 3.0, 2.0 * 3.0 * 1.2
    x, y = 0.5 - point[0], -0.5 - point[1]  # middle of the waterplane from the point
    lift = volume * (-0.6 - point[2])
    assert mesh_problems(mesh) == []
    assert h.volume == pytest.approx(volume) and h.waterplane == pytest.approx(area)
    np.testing.assert_allclose(h.centre, [0.5, -0.5, -0.6], atol=1e-12)
    wanted = np.zeros((6, 6))
    wanted[2, 2] = area
    wanted[2, 3] = wanted[3, 2] = area * y
    wanted[2, 4] = wanted[4, 2] = -area * x
    wanted[3, 3] = area * (3.0**2 / 12.0 + y**2) + lift
    wanted[4, 4] = area * (2.0**2 / 12.0 + x**2) + lift
    wanted[3, 4] = wanted[4, 3] = -area * x * y
    wanted[3, 5], wanted[4, 5] = -volume * x, -volume * y
    np.testing.assert_allclose(h.stiffness, wanted, atol=1e-12)


def test_hemisphere_converges_with_second_order_and_keeps_its_waterplane():
    exact = 2.0 / 3.0 * math.pi * 8.0
    coarse, fine = (hydrostatics(hemisphere(n, 2 * n)) for n in (10, 20))
    errors = [abs(h.volume / exact - 1.0) for h in (coarse, fine)]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    assert fine.waterplane == pytest.approx(4.0 * math.pi, rel=1e-12)
    assert fine.centre[2] == pytest.approx(-0.75, rel=5e-3)
    assert mesh_problems(hemisphere()) == []


def test_profile_keeps_its_corners_and_is_finer_at_sharp_ones():
    points = profile([(0.0, -2.0), (3.0, -2.0), (3.0, 0.0)], 0.5, sharp=[1])
    assert np.any(np.all(np.abs(points - (3.0, -2.0)) < 1e-12, axis=1))
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    corner = int(np.argmin(np.linalg.norm(points - (3.0, -2.0), axis=1)))
    assert max(steps[corner - 1], steps[corner]) < 0.5 * steps[0]
    np.testing.assert_allclose(graded(1.0, -1.0, 0.5), [1.0, 0.5, 0.0, -0.5, -1.0])


def test_union_of_boxes_has_no_panels_inside():
    (mesh,) = box_mesh([((0.0, 2.0), (0.0, 2.0), (-2.0, -1.0)), ((1.0, 3.0), (1.0, 3.0), (-1.5, 0.0))])
    assert mesh_problems(mesh) == []
    assert hydrostatics(mesh).volume == pytest.approx(4.0 + 6.0 - 0.5)
    assert hydrostatics(mesh).waterplane == pytest.approx(4.0)


def test_bodies_that_touch_share_no_panels():
    left, right = box_mesh([((0.0, 1.0), (0.0, 1.0), (-1.0, 0.0))], [((1.0, 2.0), (0.0, 1.0), (-2.0, 0.0))])
    assert mesh_problems(join(left, right)) == []
    assert "free" in mesh_problems(left)[0]
    assert np.abs(left.vertices[left.faces, 0] - 1.0).max(axis=1).min() > 0.1  # no panel where they touch
    assert hydrostatics(join(left, right)).volume == pytest.approx(3.0)


def test_boxes_refuse_what_is_off_the_grid_and_bodies_in_one_place():
    lines = (np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.array([-1.0, 0.0]))
    with pytest.raises(ValueError, match="not between planes"):
        boxes([[((0.0, 0.5), (0.0, 1.0), (-1.0, 0.0))]], lines)
    unit = ((0.0, 1.0), (0.0, 1.0), (-1.0, 0.0))
    with pytest.raises(ValueError, match="in another body"):
        boxes([[unit], [unit]], lines)


def test_lid_points_down_and_covers_the_waterplane():
    lid = rectangle(np.linspace(0.0, 2.0, 4), np.linspace(0.0, 3.0, 3), -0.1)
    assert hydrostatics(lid).waterplane == pytest.approx(6.0)  # minus the integral of n_z
    disc = revolve(np.column_stack([np.linspace(0.0, 2.0, 4), np.full(4, -0.1)]), 12)
    assert hydrostatics(disc).waterplane == pytest.approx(4.0 * math.pi)


@pytest.mark.parametrize("symmetry", [Symmetry(("xOz",)), Symmetry(("xOz", "yOz")), Symmetry(turns=6)])
def test_images_of_a_sector_are_the_whole_body(symmetry):
    sector = {
        ("xOz",): [((-0.5, 1.5), (0.0, 2.0), (-1.2, 0.0))],
        ("xOz", "yOz"): [((0.0, 1.5), (0.0, 2.0), (-1.2, 0.0))],
    }.get(symmetry.mirrors)
    if sector is None:
        theta = 0.5 * np.pi * np.arange(9) / 8
        part = revolve(np.column_stack([np.sin(theta), -np.cos(theta)]), 6, images=1)
        whole, volume = images(part, symmetry.operations()), None
    else:
        (part,) = box_mesh(sector)
        on_plane = np.abs(part.vertices[part.faces, 1]).max(axis=1) < 1e-9
        if len(symmetry.mirrors) == 2:
            on_plane |= np.abs(part.vertices[part.faces, 0]).max(axis=1) < 1e-9
        whole = images(Mesh(part.vertices, part.faces[~on_plane]), symmetry.operations())
        volume = 2.0 * 2.0 * 2.0 * 1.2 if len(symmetry.mirrors) == 1 else 3.0 * 4.0 * 1.2
    assert mesh_problems(whole) == []
    if volume:
        assert hydrostatics(whole).volume == pytest.approx(volume)


def test_problems_name_what_is_wrong():
    (mesh,) = box_mesh([BOX])
    assert "free" in mesh_problems(Mesh(mesh.vertices, mesh.faces[1:]))[0]
    assert "twice" in mesh_problems(Mesh(mesh.vertices, np.concatenate([mesh.faces, mesh.faces[:1]])))[0]
    assert "counter-clockwise" in mesh_problems(Mesh(mesh.vertices, mesh.faces[:, ::-1]))[0]
    assert "above z = 0" in mesh_problems(Mesh(mesh.vertices + (0.0, 0.0, 0.3), mesh.faces))[0]
    assert any("seabed" in text for text in mesh_problems(mesh, depth=1.0))
    flipped = mesh.faces.copy()
    flipped[0] = flipped[0, ::-1]
    assert "opposite ways" in mesh_problems(Mesh(mesh.vertices, flipped))[0]


def test_a_body_on_the_seabed_may_be_open_there():
    (mesh,) = box_mesh([((0.0, 1.0), (0.0, 1.0), (-5.0, -4.0))])
    bottom = mesh.vertices[mesh.faces, 2].max(axis=1) < -5.0 + 1e-9
    standing = Mesh(mesh.vertices, mesh.faces[~bottom])
    assert mesh_problems(standing, depth=5.0) == []
    assert mesh_problems(standing) != []
    assert any("leave them out" in text for text in mesh_problems(mesh, depth=5.0))


def test_hash_tells_meshes_apart():
    mesh = hemisphere(8, 8)
    assert mesh_hash(mesh) == mesh_hash(hemisphere(8, 8))
    assert mesh_hash(mesh) != mesh_hash(Mesh(mesh.vertices * 1.001, mesh.faces))


def closed_ball(rings, around, sink):
    theta = np.pi * np.arange(rings + 1) / rings
    mesh = revolve(np.column_stack([np.sin(theta), -np.cos(theta)]), around)
    return Mesh(mesh.vertices - (0.0, 0.0, sink), mesh.faces)


def test_hull_cut_at_the_waterline_displaces_the_cap():
    # a sphere of radius 1 whose centre is 0.3 m under water: spherical cap of height 1.3 m
    volume, area = math.pi * 1.3**2 * (1.0 - 1.3 / 3.0), math.pi * (1.0 - 0.09)
    errors = []
    for n in (12, 24, 48):
        cut = wetted(closed_ball(n, 2 * n, 0.3))
        assert mesh_problems(cut) == []
        h = hydrostatics(cut)
        errors.append(abs(h.volume / volume - 1.0))
        cover = lid(cut, 0.05, -0.02)
        assert hydrostatics(cover).waterplane == pytest.approx(h.waterplane, rel=0.03)
    assert errors[2] < 2e-3 and errors[0] / errors[2] == pytest.approx(16.0, rel=0.3)
    assert h.waterplane == pytest.approx(area, rel=5e-3)


def test_tilted_box_cut_at_the_waterline():
    x, y, z = (np.linspace(a, b, n) for a, b, n in ((-1.0, 1.0, 5), (-2.0, 2.0, 7), (-2.0, -1.0, 4)))
    (block,) = boxes([[((-1.0, 1.0), (-2.0, 2.0), (-2.0, -1.0))]], (x, y, z))
    c, s = math.cos(0.3), math.sin(0.3)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    cut = wetted(Mesh((block.vertices + (0.0, 0.0, 1.5)) @ turn.T, block.faces))
    h = hydrostatics(cut)
    assert mesh_problems(cut) == []
    # turned about its middle, which is in the waterline: half of it is under water; deck and bottom both are cut
    assert h.volume == pytest.approx(4.0, rel=1e-9)
    assert h.waterplane == pytest.approx(2.0 * 1.0 / s, rel=1e-9)  # across the whole thickness of 1 m


@pytest.mark.parametrize("off", [0.02, -0.02, 1e-7, -1e-7, 0.0])
def test_rings_near_the_waterline_leave_no_slivers(off):
    """A tube with a ring `off` the waterline, rings 0.5 m apart; its walls are upright, so nothing of it is lost."""
    outline = np.array([[0.0, -2.0], [1.0, -2.0], *([1.0, z] for z in (-1.5, -1.0, -0.5, 0.0, 0.5, 1.0)), [0.0, 1.0]])
    tube = revolve(outline + (0.0, off), 16)
    cut = wetted(to_waterline(tube))
    assert mesh_problems(cut) == [] and len(cut.faces) == 5 * 16
    assert hydrostatics(cut).volume == pytest.approx(math.pi * (2.0 - off), rel=1e-12)
    plain = wetted(tube)
    assert hydrostatics(plain).volume == pytest.approx(math.pi * (2.0 - off), rel=1e-9)
    assert (len(plain.faces) > len(cut.faces)) == (off < 0.0)


def test_rings_near_the_waterline_of_a_ball():
    ball = closed_ball(24, 48, -math.cos(13.05 * math.pi / 24))  # between two rings, a twentieth from one
    volume = hydrostatics(wetted(ball)).volume
    cut = wetted(to_waterline(ball))
    assert mesh_problems(cut) == [] and hydrostatics(cut).volume == pytest.approx(volume, rel=2e-4)

    def lowest(mesh):
        """Height of the lowest panel at the waterline; rings are 0.13 apart."""
        z = mesh.vertices[mesh.faces, 2]
        return np.ptp(z, axis=1)[z.max(axis=1) == 0.0].min()

    assert lowest(wetted(ball)) == pytest.approx(0.05 * math.pi / 24, rel=0.05) and lowest(cut) > 0.9 * math.pi / 24


def test_a_lid_needs_a_waterline():
    with pytest.raises(ValueError, match="under water"):
        lid(closed_ball(6, 8, 3.0), 0.2, -0.1)
