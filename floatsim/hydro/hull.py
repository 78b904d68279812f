"""The surface of a floater as a closed mesh of triangles: readers, checks, hydrostatics of its wetted part.

The mesh covers the whole body, above the water too: what is wet follows from where the body is. Corners run
counter-clockwise seen from outside, so that normals point out of the body (STL, WAMIT and Nemoh agree in that). Nothing
is repaired: a mesh with holes, with triangles turned over or without area is refused, and the triangles are named.

STL, the format with two encodings and many dialects, is left to numpy-stl; the tables of WAMIT's geometric data file
and of Nemoh's mesh file are read here (WAMIT 7 manual, chapter 6; Nemoh v3 manual, mesh format).
"""

from __future__ import annotations

import gzip
import io
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floatsim.description import Description, Positive, Vector3
from floatsim.errors import ModelError
from floatsim.frames import Array, matrix_from_angles
from floatsim.hydro.froude_krylov import HullLoads
from floatsim.hydro.meshing import hydrostatics_of
from floatsim.parts.part import Part

Index = NDArray[np.int64]

_SAME = 1e-6  # of the mesh's size: corners closer than this are one
_SLIVER = 1e-7  # of the longest side: triangles less high than this have no area
_NAMED = 3  # offending triangles that a message lists


class Surface(NamedTuple):
    """Triangles: vertices (n, 3), m; faces (m, 3); number (m,) of the file's panel that each comes from, from 1."""

    vertices: Array
    faces: Index
    number: Index

    @property
    def corners(self) -> Array:
        """Corners of the triangles (m, 3, 3), m."""
        return np.asarray(self.vertices[self.faces])


class Hydrostatics(NamedTuple):
    """Of the wetted part in still water.

    volume m3; centre_of_buoyancy (3,) m, world; waterplane_area m2; waterplane_centre (2,) m, world;
    waterplane_inertia (2, 2) m4, second moments int x x, int x y, int y y about the reference point's vertical;
    stiffness (6, 6) about the reference point: waterplane + rho g V z_B, without weight.
    """

    volume: float
    centre_of_buoyancy: Array
    waterplane_area: float
    waterplane_centre: Array
    waterplane_inertia: Array
    stiffness: Array


class Hull(Description):
    """Nonlinear hydrostatics and Froude-Krylov forces on a surface mesh. Give it to `Body(hydro=...)` alone, or to
    `PotentialFlow(hull=...)`, where it replaces the linear ones.

    mesh: path of an STL file, a WAMIT .gdf or a Nemoh .dat mesh, each plain or .gz, or a pair (vertices, faces) of
    corners (n, 3) [m] and indices (m, 3) or (m, 4) from 0. scale: factor on its coordinates. mesh_origin [m]: where
    the (scaled) mesh's origin stands from the body's reference point, body axes. mirror: "x", "y" or "xy" completes
    half or quarter a mesh by its image with x or y negated (symmetries a file states itself are followed anyway).
    inside_out: True for a mesh whose corners run the other way round everywhere.

    Raises ModelError for a file that cannot be read and for a mesh that is not closed, not consistently outward,
    encloses no volume or has degenerate triangles, naming triangles.
    """

    mesh: Any
    mesh_origin: Vector3 = (0.0, 0.0, 0.0)
    scale: Positive = 1.0
    mirror: Literal["", "x", "y", "xy"] = ""
    inside_out: bool = False

    def model_post_init(self, context: Any) -> None:
        problems = _problems(self.surface)
        if problems:
            raise ModelError([f"{self._label}: {line}" for line in problems])

    @property
    def _label(self) -> str:
        return f"Hull: mesh '{self.mesh}'" if isinstance(self.mesh, str | Path) else "Hull: mesh"

    @cached_property
    def surface(self) -> Surface:
        """The triangles in body axes, from the reference point."""
        try:
            soup = _read(Path(self.mesh)) if isinstance(self.mesh, str | Path) else _given(self.mesh)
        except ModelError as error:
            raise ModelError([f"{self._label}: {line}" for line in error.problems]) from None
        for axis in self.mirror:
            soup = _with_image(soup, "xyz".index(axis))
        vertices, faces, number = _merged(soup)
        if self.inside_out:
            faces = np.ascontiguousarray(faces[:, ::-1])
        return Surface(self.scale * vertices + np.array(self.mesh_origin), faces, number)

    @property
    def enclosed_volume(self) -> float:
        """Of the whole closed surface [m3]."""
        return float(_cones(self.surface.corners).sum())

    def files(self) -> list[str | Path]:
        """Files its numbers come from."""
        return [self.mesh] if isinstance(self.mesh, str | Path) else []

    def attached_to(self, body: Any) -> list[Part]:
        """The part that carries these loads.

        Raises ModelError if it stands beside a description that has hydrostatics of its own.
        """
        others = [load for load in body.water_loads if load is not self]
        if len(others) < len(body.water_loads) and any(hasattr(load, "database") for load in others):
            raise ModelError(
                f"Body '{body.name}': hydro has a Hull beside a PotentialFlow, and buoyancy would count twice; give "
                "PotentialFlow(..., hull=Hull(...))"
            )
        earlier = body.water_loads[: next((k for k, load in enumerate(body.water_loads) if load is self), 0)]
        same = sum(isinstance(load, Hull) for load in earlier)
        return [HullLoads(name=f"{body.name}.hull" + (f"_{same + 1}" if same else ""), body=body, hull=self)]

    def hydrostatics(
        self,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude_deg: Sequence[float] = (0.0, 0.0, 0.0),
        *,
        density: float = 1025.0,
        gravity: float = 9.81,
    ) -> Hydrostatics:
        """Of the part below z = 0 with the reference point at `position` [m] and roll, pitch, yaw `attitude_deg`.

        Closed forms of the polyhedron: the lid at z = 0 adds nothing to the integrals of `meshing.hydrostatics_of`.
        """
        ref = np.array(position, dtype=np.float64)
        x = self.surface.vertices @ matrix_from_angles(*np.radians(attitude_deg)).T + [0.0, 0.0, ref[2]]
        volume, centre, area, C = hydrostatics_of(below(x, self.surface.faces), (0.0, 0.0, float(ref[2])))
        lift = volume * (centre[2] - ref[2])
        inertia = np.array([[C[4, 4] - lift, -C[3, 4]], [-C[3, 4], C[3, 3] - lift]])
        beside = np.array([ref[0], ref[1], 0.0])
        flotation = np.array([-C[2, 4], C[2, 3]]) / max(area, 1e-300) + ref[:2]
        return Hydrostatics(volume, centre + beside, area, flotation, inertia, density * gravity * C)


def below(vertices: Array, faces: Index) -> Array:
    """Corners (m, 3, 3) of the parts of triangles that are below z = 0, cut where they cross it."""
    wet = vertices[faces, 2] < 0.0
    count = wet.sum(axis=1)
    pieces = [vertices[faces[count == 3]]]
    for n in (1, 2):
        some, odd = faces[count == n], np.argmax(wet[count == n] == (n == 1), axis=1)
        a, b, c = (vertices[np.take_along_axis(some, ((odd + k) % 3)[:, None], axis=1)[:, 0]] for k in range(3))
        ab, ac = (a + (a[:, 2:] / (a[:, 2:] - other[:, 2:])) * (other - a) for other in (b, c))
        pieces += [np.stack([a, ab, ac], axis=1)] if n == 1 else [np.stack([ab, b, c], 1), np.stack([ab, c, ac], 1)]
    return np.concatenate(pieces)


# --- what can be read ---------------------------------------------------------------------------


def _read(path: Path) -> Surface:
    endings = [ending.lower() for ending in path.suffixes[-2:]]
    packed = endings[-1:] == [".gz"]
    ending = (endings[:-1] if packed else endings)[-1:]
    readers = {".stl": _stl, ".gdf": _gdf, ".dat": _nemoh}
    if not ending or ending[0] not in readers:
        raise ModelError("the kind of file is told by its name, which must end in .stl, .gdf or .dat, or these and .gz")
    try:
        data = gzip.decompress(path.read_bytes()) if packed else path.read_bytes()
    except (OSError, EOFError) as error:
        raise ModelError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    return readers[ending[0]](data)


def _stl(data: bytes) -> Surface:
    from stl import mesh

    try:
        triangles = mesh.Mesh.from_file("mesh.stl", fh=io.BytesIO(data), calculate_normals=False).vectors
    except Exception as error:  # whatever a broken file makes of it
        raise ModelError(f"cannot be read as STL: {error}") from None
    if len(triangles) == 0:
        raise ModelError("there are no triangles in it")
    return _panels(np.asarray(triangles, dtype=np.float64))


def _numbers(data: bytes, first: int) -> Array:
    """All numbers of a text file from line `first` (from 0) on."""
    lines = data.decode("ascii", errors="replace").upper().replace("D", "E").splitlines()[first:]
    values = []
    for number, line in enumerate(lines, first + 1):
        try:
            values += [float(word) for word in line.split()]
        except ValueError:
            raise ModelError(f"line {number}: not numbers: '{line.strip()[:60]}'") from None
    return np.array(values)


def _gdf(data: bytes) -> Surface:
    """WAMIT: a title, ULEN GRAV, ISX ISY, NPAN, then four corners of each panel."""
    lines = data.decode("ascii", errors="replace").splitlines()
    try:
        planes = [int(word) for word in lines[2].split()[:2]]
        count = lines[3].split()
        n = int(count[0])
    except (IndexError, ValueError):
        raise ModelError("is not a WAMIT geometric data file: ULEN GRAV, ISX ISY and NPAN follow its title") from None
    if len(count) > 1 and count[1].lstrip("-").isdigit():
        raise ModelError("is of WAMIT's higher-order method (patches); give it as flat panels")
    if any(plane not in (0, 1) for plane in planes) or len(planes) < 2:
        raise ModelError(f"ISX ISY are {planes}, must be 0 or 1 each")
    values = _numbers(data, 4)
    if n < 1 or values.size < 12 * n:
        raise ModelError(f"{n} panels need {12 * n} numbers, the file has {values.size}")
    soup = _panels(values[: 12 * n].reshape(n, 4, 3))
    for axis, plane in enumerate(planes):
        if plane:
            soup = _with_image(soup, axis)
    return soup


def _nemoh(data: bytes) -> Surface:
    """Nemoh: `2 SYMMETRY`, numbered corners up to one numbered 0, then corners of panels up to zeros."""
    head = data.split(b"\n", 1)[0].split()
    if len(head) < 2 or head[0] != b"2" or head[1] not in (b"0", b"1"):
        raise ModelError("is not a Nemoh mesh: its first line must be '2 0', or '2 1' for half a mesh (y >= 0)")
    values = _numbers(data, 1)
    rows = values[: values.size // 4 * 4].reshape(-1, 4)
    ends = np.flatnonzero(rows[:, 0] == 0.0)
    if ends.size == 0:
        raise ModelError("the line '0 0. 0. 0.' after the corners is missing")
    corners = rows[: ends[0], 1:]
    stop = ends[1] if ends.size > 1 else len(rows)
    soup = _given((corners, rows[ends[0] + 1 : stop].astype(np.int64) - 1))
    return _with_image(soup, 1) if head[1] == b"1" else soup


def _given(mesh: Any) -> Surface:
    """From vertices and faces."""
    try:
        vertices, faces = mesh
        vertices, given = np.array(vertices, dtype=np.float64), np.array(faces)
        faces = given.astype(np.int64)
        good = vertices.ndim == 2 and vertices.shape[1] == 3 and faces.ndim == 2 and faces.shape[1] in (3, 4)
        good = good and len(faces) > 0 and bool(np.all(faces == given))
    except (TypeError, ValueError):
        good = False
    if not good:
        raise ModelError(
            "must be the path of an .stl, .gdf or .dat file, or a pair (vertices, faces): (n, 3) coordinates [m] and "
            "(m, 3) or (m, 4) whole numbers, indices from 0"
        )
    wrong = np.flatnonzero(((faces < 0) | (faces >= len(vertices))).any(axis=1))
    if wrong.size:
        raise ModelError(f"panel {wrong[0] + 1} has a corner that is not one of the {len(vertices)} vertices")
    return _panels(vertices[faces])


def _panels(corners: Array) -> Surface:
    """Triangles without common corners from panels of three or four corners (n, 3 or 4, 3)."""
    n, sides = corners.shape[:2]
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if bad.size:
        raise ModelError(f"panel {bad[0] + 1} has coordinates that are not finite")
    number = np.arange(1, n + 1)
    if sides == 3:
        return Surface(corners.reshape(-1, 3), np.arange(3 * n).reshape(n, 3), number)
    split = np.array([[0, 1, 2], [0, 2, 3]])
    faces = (4 * np.arange(n)[:, None, None] + split).reshape(-1, 3)
    number = np.repeat(number, 2)
    # a panel of four corners two of which coincide is how these formats write a triangle
    side = corners[:, [1, 2, 2, 3, 3]] - corners[:, [0, 1, 0, 2, 0]]
    short = np.linalg.norm(side, axis=2) <= _SAME * _size(corners.reshape(-1, 3))
    none = np.stack([short[:, 0] | short[:, 1], short[:, 3] | short[:, 4]], axis=1) & (short.sum(axis=1) == 1)[:, None]
    keep = ~none.ravel()
    return Surface(corners.reshape(-1, 3), faces[keep], number[keep])


def _with_image(soup: Surface, axis: int) -> Surface:
    image = soup.vertices.copy()
    image[:, axis] *= -1.0
    faces = np.concatenate([soup.faces, soup.faces[:, ::-1] + len(image)])
    return Surface(np.concatenate([soup.vertices, image]), faces, np.tile(soup.number, 2))


def _merged(soup: Surface) -> Surface:
    """The same triangles with corners at the same place made one, unused ones left out."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    x = soup.vertices
    pairs = cKDTree(x).query_pairs(_SAME * _size(x), output_type="ndarray")
    ones = np.ones(len(pairs), dtype=np.int8)
    _, group = connected_components(coo_matrix((ones, (pairs[:, 0], pairs[:, 1])), shape=(len(x), len(x))))
    used, faces = np.unique(group[soup.faces], return_inverse=True)
    _, first = np.unique(group, return_index=True)
    return Surface(x[first[used]], faces.reshape(soup.faces.shape).astype(np.int64), soup.number)


def _size(x: Array) -> float:
    return float(np.linalg.norm(np.ptp(x, axis=0)))


# --- is it a hull? ------------------------------------------------------------------------------


def _problems(mesh: Surface) -> list[str]:
    """What is wrong with a mesh: sentences that name triangles."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    corners = mesh.corners
    side = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    twice = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    longest = side.max(axis=1)
    flat = np.flatnonzero(twice <= _SLIVER * longest**2)
    if flat.size:
        return [f"{_count(flat, 'triangle', 'has', 'have')} no area: {_name(mesh, flat)}; remove them or mesh anew"]
    start, end = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    owner = np.repeat(np.arange(len(mesh.faces)), 3)
    n = len(mesh.vertices)
    ahead, back = start * n + end, end * n + start
    kinds, count = np.unique(ahead, return_counts=True)
    alone = owner[~np.isin(ahead, back)]
    double = owner[np.isin(ahead, kinds[count > 1])]
    turned = np.flatnonzero(np.bincount(double, minlength=len(owner) // 3) * np.isin(owner[::3], alone) == 3)
    if turned.size == 0:
        turned = np.intersect1d(double, alone)
    if turned.size:  # the same side run through the same way by two triangles, and nothing the other way
        return [f"{_count(turned, 'triangle', 'is', 'are')} turned against a neighbour (their corners run the other "
                f"way round) or folded onto one: {_name(mesh, turned)}"]  # fmt: skip
    if double.size:
        double = np.unique(double)
        return [f"{_count(double, 'triangle', 'shares', 'share')} a side with more than one other: "
                f"{_name(mesh, double)}; remove inner and doubled panels"]  # fmt: skip
    if alone.size:
        rim = mesh.vertices[start[~np.isin(ahead, back)], 2]
        level = np.ptp(rim) <= 1e-3 * _size(mesh.vertices)
        hint = (
            f"; its rim lies level at z = {rim.mean():.4g} m: a nonlinear hull needs its sides above the water, and a "
            "deck, too"
            if level else "; is a side missing, or a symmetry (mirror)?"
        )  # fmt: skip
        alone = np.unique(alone)
        return [f"is not closed: {_count(alone, 'triangle', 'has', 'have')} a side without a neighbour: "
                f"{_name(mesh, alone)}{hint}"]  # fmt: skip
    pieces, piece = connected_components(coo_matrix((np.ones(start.size), (start, end)), shape=(n, n)))
    cone = _cones(corners)
    for k in range(pieces):
        mine = np.flatnonzero(piece[mesh.faces[:, 0]] == k)
        volume = float(cone[mine].sum())
        what = "it" if pieces == 1 else f"the piece of {len(mine)} triangles"
        if abs(volume) <= 1e-9 * _size(mesh.vertices[mesh.faces[mine]].reshape(-1, 3)) ** 3:
            return [f"{what} encloses no volume ({volume:.4g} m3): {_name(mesh, mine)}"]
        if volume < 0.0:
            return [f"is inside out: {what} encloses {volume:.4g} m3: {_name(mesh, mine)}; corners must run "
                    "counter-clockwise seen from outside (inside_out=True turns all of them)"]  # fmt: skip
    return []


def _cones(corners: Array) -> Array:
    """Volumes (m,) between triangles and the origin, m3, negative where they face it."""
    return np.asarray(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)


def _count(which: Index, what: str, one: str, many: str) -> str:
    return f"{len(which)} {what} {one}" if len(which) == 1 else f"{len(which)} {what}s {many}"


def _name(mesh: Surface, which: Index) -> str:
    """The first few by number and place."""
    named = []
    for k in which[:_NAMED]:
        middle = ", ".join(f"{y + 0.0:.4g}" for y in mesh.corners[k].mean(axis=0))
        named.append(f"number {mesh.number[k]} at ({middle})")
    return "; ".join(named) + (" and more" if len(which) > _NAMED else "")
