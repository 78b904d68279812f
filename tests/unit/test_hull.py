"""Hull meshes: what is read, from which format, and what is refused by name."""

import gzip
import struct

import numpy as np
import pytest
from hulls import box, cylinder, ellipsoid
from shipped import HYDRO

import floatsim as fs
from floatsim.hydro.hull import Hull
from floatsim.study.sheet import body_sheets

VERTICES, FACES = box(4.0, 3.0, 2.0, (3, 2, 2))
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])


def ascii_stl(corners):
    lines = ["solid hull"]
    for triangle in corners:
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += [f"      vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in triangle]
        lines += ["    endloop", "  endfacet"]
    return ("\n".join([*lines, "endsolid hull"]) + "\n").encode()


def binary_stl(corners):
    rows = [struct.pack("<12fH", 0.0, 0.0, 0.0, *map(float, triangle.ravel()), 0) for triangle in corners]
    return b"a hull".ljust(80) + struct.pack("<I", len(rows)) + b"".join(rows)


def gdf(panels, isx=0, isy=0):
    head = ["a hull", "1.0 9.80665", f"{isx} {isy}", f"{len(panels)}"]
    return "\n".join([*head, *(" ".join(f"{y:.9g}" for y in panel.ravel()) for panel in panels)]).encode()


def nemoh(vertices, faces, symmetric=0):
    lines = [f"2 {symmetric}", *(f"{i + 1} {x:.9g} {y:.9g} {z:.9g}" for i, (x, y, z) in enumerate(vertices))]
    lines += ["0 0. 0. 0.", *(" ".join(str(k + 1) for k in face) for face in faces), "0 0 0 0"]
    return "\n".join(lines).encode()


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.stl", ascii_stl(VERTICES[FACES])),
        ("b.stl", binary_stl(VERTICES[FACES])),
        ("c.gdf", gdf(4.0 * CUBE[QUADS] * (1.0, 0.75, 0.5) - (2.0, 1.5, 1.0))),
        ("d.dat", nemoh(4.0 * CUBE * (1.0, 0.75, 0.5) - (2.0, 1.5, 1.0), QUADS)),
    ],
)
def test_formats(tmp_path, name, data, packed):
    path = tmp_path / (name + ".gz" * packed)
    path.write_bytes(gzip.compress(data) if packed else data)
    hull = Hull(mesh=path)
    assert hull.enclosed_volume == pytest.approx(24.0)
    assert np.ptp(hull.surface.vertices, axis=0) == pytest.approx([4.0, 3.0, 2.0])
    assert hull.files() == [path]
    if name.endswith(".stl"):
        assert len(hull.surface.vertices) == len(Hull(mesh=(VERTICES, FACES)).surface.vertices)


def half(keep):
    """Quadrilaterals of a cube of side 2 about the origin that `keep` leaves (its sides in 2 x 2), as corners."""
    cube = box(2.0, 2.0, 2.0, (2, 2, 2))
    pairs = cube[1].reshape(-1, 2, 3)
    quads = np.concatenate([pairs[:, 0], pairs[:, 1, 2:]], axis=1)
    corners = cube[0][quads]
    return corners[keep(corners.mean(axis=1))]


def test_symmetries_are_followed(tmp_path):
    quarter, side = half(lambda p: (p[:, 0] > 0.0) & (p[:, 1] > 0.0)), half(lambda p: p[:, 1] > 0.0)
    n = 4 * np.arange(len(side))[:, None] + np.arange(4)
    files = {"q.gdf": gdf(quarter, 1, 1), "h.gdf": gdf(side, 0, 1), "h.dat": nemoh(side.reshape(-1, 3), n, 1)}
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
        assert Hull(mesh=tmp_path / name).enclosed_volume == pytest.approx(8.0), name
    (tmp_path / "h.stl").write_bytes(ascii_stl(side[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3)))
    assert Hull(mesh=tmp_path / "h.stl", mirror="y").enclosed_volume == pytest.approx(8.0)
    m = 4 * np.arange(len(quarter))[:, None] + np.arange(4)
    assert Hull(mesh=(quarter.reshape(-1, 3), m), mirror="xy").enclosed_volume == pytest.approx(8.0)


def test_triangles_written_as_panels(tmp_path):
    """A panel with two corners in one place is a triangle, whichever two they are."""
    tip = np.array([0.0, 0.0, 1.0])
    base = np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0]])
    sides = [[base[i], base[(i + 1) % 4], tip] for i in range(4)]
    doubled = [[*side[:k], side[k], *side[k:]] for side, k in zip(sides, (0, 1, 2, 2))]
    (tmp_path / "pyramid.gdf").write_bytes(gdf(np.array([*doubled, base[::-1]])))
    hull = Hull(mesh=tmp_path / "pyramid.gdf")
    assert len(hull.surface.faces) == 6
    assert hull.enclosed_volume == pytest.approx(4.0 / 3.0)


def test_placed():
    hull = Hull(mesh=(VERTICES, FACES), scale=2.0, mesh_origin=(10.0, 0.0, -1.0))
    assert hull.surface.vertices.min(axis=0) == pytest.approx([6.0, -3.0, -3.0])
    turned = Hull(mesh=(VERTICES, FACES[:, ::-1]), inside_out=True)
    assert turned.enclosed_volume == pytest.approx(24.0)


def refused(mesh, *words, **more):
    with pytest.raises(fs.ModelError) as caught:
        Hull(mesh=mesh, **more)
    text = str(caught.value)
    for word in words:
        assert word in text, text
    assert "Traceback" not in text


def test_bad_meshes_are_named():
    v, f = cylinder(1.0, -2.0, 1.0, 12)
    k = 7
    middle = ", ".join(f"{y:.4g}" for y in v[f[k]].mean(axis=0))
    refused((v, np.delete(f, k, axis=0)), "not closed", "3 triangles have a side without a neighbour", "number")
    one = f.copy()
    one[k] = one[k, ::-1]
    refused((v, one), "1 triangle is turned", f"number {k + 1} at ({middle})")
    refused((v, np.vstack([f, f[k]])), "number 8", "doubled")
    refused((v, f[:, ::-1]), "inside out", "inside_out=True")
    flat = f.copy()
    flat[k] = flat[k, [0, 1, 1]]
    refused((v, flat), "1 triangle has no area", f"number {k + 1} at (")
    sliver = np.vstack([f, [[0, 1, 0]]])
    refused((v, sliver), "no area", f"number {len(f) + 1}")


def test_open_at_the_waterline():
    """A panel mesh for linear hydrodynamics ends at the water."""
    v, f = cylinder(1.0, -2.0, 0.0, 12)
    wet = f[(f != len(v) - 1).all(axis=1)]
    refused((v, wet), "12 triangles", "its rim lies level at z = 0 m", "deck")


def test_one_piece_of_several_inside_out():
    v, f = ellipsoid(1.0, 1.0, 1.0, 3)
    both = np.vstack([v, v + (5.0, 0.0, 0.0)])
    assert Hull(mesh=(both, np.vstack([f, f + len(v)]))).enclosed_volume > 0.0
    refused((both, np.vstack([f, f[:, ::-1] + len(v)])), "inside out", f"piece of {len(f)} triangles", "at (5")


def test_bad_input(tmp_path):
    good = (VERTICES, FACES)
    refused(3.0, "(vertices, faces)")
    refused((VERTICES, FACES + 100), "panel 1", "vertices")
    refused((VERTICES[:, :2], FACES), "(vertices, faces)")
    refused((VERTICES, FACES + 0.5), "whole numbers")
    refused((np.where(VERTICES == 2.0, np.nan, VERTICES), FACES), "not finite")
    refused(good, "scale", scale=-1.0)
    refused(good, "mirror", mirror="z")
    refused(good, "mesh_origin", mesh_origin=(0.0, 0.0))
    refused(tmp_path / "no.stl", "no.stl", "cannot be read")
    refused(tmp_path / "no.obj", "no.obj", ".stl, .gdf or .dat")
    for name, data, word in (
        ("empty.stl", b"", "STL"),
        ("text.stl", b"solid this is\nno STL\n", "no triangles"),
        ("short.stl", binary_stl(VERTICES[FACES])[:300], "STL"),
        ("title.gdf", b"only a title", "ULEN GRAV"),
        ("high.gdf", b"t\n1 9.8\n0 0\n4 1\n", "higher-order"),
        ("few.gdf", gdf(CUBE[QUADS])[:-20], "72"),
        ("word.gdf", gdf(CUBE[QUADS]).replace(b"9.80665\n0 0\n6\n0", b"9.8\n0 0\n6\nzero"), "line 5"),
        ("plane.gdf", gdf(CUBE[QUADS], 2, 0), "ISX ISY"),
        ("bad.dat", b"1 2 3\n", "Nemoh"),
        ("open.dat", b"2 0\n1 0. 0. 0.\n", "0 0. 0. 0."),
        ("bad.stl.gz", b"not gzip", "cannot be read"),
    ):
        (tmp_path / name).write_bytes(data)
        refused(tmp_path / name, name, word)


def test_it_is_a_water_load():
    hull = Hull(mesh=(VERTICES, FACES))
    body = fs.Body(name="barge", mass=1e3, inertia=(1e3, 1e3, 1e3), hydro=hull)
    (part,) = hull.attached_to(body)
    assert part.name == "barge.hull" and part.n_points == 0
    fs.assemble(fs.Model(parts=[body], sea=fs.Sea(depth=10.0)))


def test_hulls_in_company():
    hull = Hull(mesh=(VERTICES, FACES))
    body = dict(mass=1e3, inertia=(1e3, 1e3, 1e3))
    pair = fs.Body(name="pair", hydro=[hull, Hull(mesh=(VERTICES, FACES), mesh_origin=(0.0, 6.0, 0.0))], **body)
    assert [part.name for part in pair.children()] == ["pair.hull", "pair.hull_2"]
    run = fs.simulate(fs.Model(parts=[pair], sea=fs.Sea(depth=10.0)), 0.1, state=None)
    assert run.series("pair_displaced_volume")[0] == pytest.approx(1e3 / 1025.0)
    flow = fs.PotentialFlow(database=HYDRO)
    with pytest.raises(fs.ModelError, match="count twice"):
        fs.assemble(fs.Model(parts=[fs.Body(name="twice", hydro=[hull, flow], **body)], sea=fs.Sea(depth=200.0)))


def test_equilibrium_sheet():
    """`check` tells the buoyancy of the mesh where it is drawn."""
    hull = Hull(mesh=(VERTICES, FACES))
    barge = fs.Body(name="barge", mass=1e4, inertia=(1e4, 1e4, 1e4), position=(0.0, 0.0, 0.25), hydro=hull)
    (sheet,) = body_sheets(fs.assemble(fs.Model(parts=[barge], sea=fs.Sea(depth=10.0, density=1000.0))))
    assert sheet.buoyancy == pytest.approx(1000.0 * 9.81 * 9.0, rel=1e-3)
    assert sheet.heave == pytest.approx(9.0 / 12.0 - 10.0 / 12.0, rel=1e-3)
    np.testing.assert_allclose(sheet.attached, 0.0, atol=1e-6)
    assert not sheet.warnings
    heavy = barge.model_copy(update={"mass": 3e4})
    (sheet,) = body_sheets(fs.assemble(fs.Model(parts=[heavy], sea=fs.Sea(depth=10.0, density=1000.0))))
    assert "sinks: 58.86 kN of lift are missing even with its whole hull of 24 m3" in sheet.warnings[0]
