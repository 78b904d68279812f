"""What members, discs and point buoys refuse, and in which words."""

import numpy as np
import pytest
from shipped import HYDRO

import floatsim as fs
from floatsim.parts.member import Disc, Member, MemberBatch
from floatsim.parts.point_buoy import PointBuoy

GOOD = dict(a=(0, 0, -10), b=(0, 0, 5), diameter=2.0)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (dict(b=(0, 0, -10)), "two ends are the same"),
        (dict(a=(0, 0)), "three finite|fixed point"),
        (dict(diameter=0.0), "must be a positive number or two of them (at a, at b)"),
        (dict(diameter=(1.0, -2.0)), "must be a positive number or two of them (at a, at b)"),
        (dict(diameter=(1.0, 2.0, 3.0)), "must be a positive number or two of them (at a, at b)"),
        (dict(diameter=float("nan")), "must be a positive number or two of them (at a, at b)"),
        (dict(diameter=True), "must be a positive number or two of them (at a, at b)"),
        (dict(end_drag=(0.5, -0.1)), "must be a number that is not negative or two of them (at a, at b)"),
        (dict(drag_normal=-1.0), "drag_normal: got -1.0; must be a number that is not negative"),
        (dict(added_mass_normal="1"), "added_mass_normal: got the text '1'"),
        (dict(buoyancy="yes"), "buoyancy: got 'yes'; must be True or False"),
        (dict(drag_form="x"), "drag_form: got 'x'; must be 'coupled' or 'decoupled'"),
        (dict(strips=0), "strips: got 0; must be a positive whole number"),
        (dict(strips=100_000), "strips"),
        (dict(drag_norml=1.0), "unknown argument 'drag_norml'"),
    ],
)
def test_member_refuses(values, words):
    with pytest.raises(fs.ModelError) as error:
        Member(**{**GOOD, **values})
    assert any(part in str(error.value) for part in words.split("|")), error.value
    assert str(error.value).startswith("Member")


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (dict(axis=(0, 0, 0)), "axis: got (0, 0, 0); a direction is needed"),
        (dict(drag=0.0), "drag and added_mass are both 0"),
        (dict(diameter=-1.0), "diameter: got -1.0; must be a positive number"),
    ],
)
def test_disc_refuses(values, words):
    with pytest.raises(fs.ModelError, match="Disc") as error:
        Disc(**{**dict(at=(0, 0, 0), diameter=3.0, drag=1.0), **values})
    assert words in str(error.value)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (dict(volume=0.0), "volume: got 0.0; must be a positive number"),
        (dict(mass=-1.0), "mass: got -1.0; must be a positive number"),
        (dict(height=0.0), "height: got 0.0; must be a positive number"),
        (dict(drag_area=-0.1), "drag_area: got -0.1"),
    ],
)
def test_point_buoy_refuses(values, words):
    with pytest.raises(fs.ModelError, match="PointBuoy 'buoy'") as error:
        PointBuoy(**{**dict(name="buoy", mass=10.0, volume=0.1, position=(0, 0, 0)), **values})
    assert words in str(error.value)


def model(*loads, **more):
    hull = fs.Body(name="hull", mass=2e7, inertia=(4e10, 4e10, 2e10), hydro=list(loads), **more)
    return fs.Model(parts=[hull], sea=fs.Sea(depth=200.0))


def test_points_that_the_body_does_not_have():
    """By name, with the nearest one; two names of one place."""
    points = {"foot": (0, 0, -10), "base": (0, 0, -10), "top": (0, 0, 5)}
    with pytest.raises(fs.ModelError, match=r"Body 'hull': hydro\[1\], Member: the body has no point 'fot'.*'foot'"):
        fs.assemble(model(Member(**GOOD), Member(a="fot", b="top", diameter=1.0), points=points))
    with pytest.raises(fs.ModelError, match="'foot' and 'base' are at the same place"):
        fs.assemble(model(Member(a="foot", b="base", diameter=1.0), points=points))
    with pytest.raises(fs.ModelError, match=r"hydro\[0\], Disc: the body has no point 'keel'"):
        fs.assemble(model(Disc(at="keel", diameter=1.0, drag=1.0), points=points))


def test_nothing_is_counted_twice():
    """On a body with potential flow buoyancy must be said, and a member in the database has no added mass."""
    flow = fs.PotentialFlow(database=HYDRO)
    with pytest.raises(fs.ModelError, match=r"hydro\[1\], Member: the body has potential flow.* say buoyancy=False"):
        fs.assemble(model(flow, Member(**GOOD, drag_normal=1.0)))
    with pytest.raises(fs.ModelError, match="added mass with buoyancy=False"):
        fs.assemble(model(flow, Member(**GOOD, added_mass_normal=1.0, buoyancy=False)))
    system = fs.assemble(model(flow, Member(**GOOD, drag_normal=1.0, buoyancy=False)))
    plain = fs.assemble(model(flow))
    residuals = []
    for each in (system, plain):
        w = each.work()
        each.load(w, each.initial_state())
        each.begin(w, each.initial_state(), 0.0)
        each.evaluate(w)
        residuals.append(w.r.copy())
    np.testing.assert_allclose(*residuals, atol=1e-12 * np.abs(residuals[0]).max())  # at rest in still water
    assert system.batches[-1].outputs()[0].name == "hull_member_force"


def test_flat_list_of_many_bodies():
    """Strips are grouped by body, however the parts come."""
    hulls = [
        fs.Body(name=name, mass=1e4, inertia=(1e4, 1e4, 1e4), position=(0, 9 * k, -20),
                hydro=[Member(**GOOD, strips=3 + k), Disc(at=(0, 0, -10), diameter=4.0, drag=1.0)])
        for k, name in enumerate(("one", "two"))
    ]  # fmt: skip
    system = fs.assemble(fs.Model(parts=hulls, sea=fs.Sea(depth=200.0)))
    (batch,) = [b for b in system.batches if isinstance(b, MemberBatch)]
    assert batch.first.tolist() == [0, 4, 9] and batch.where[:, 0].tolist() == [0, 1]
    names = [part.name for part in batch.parts]
    assert names == ["one.member_0", "one.disc_1", "two.member_0", "two.disc_1"]


def test_loose_parts():
    """A buoy that carries itself is not loose; a sinker that nothing holds is."""
    parts = [PointBuoy(name=name, mass=mass, volume=0.1, position=(k, 0, 0))
             for k, (name, mass) in enumerate((("buoy", 50.0), ("sinker", 500.0)))]  # fmt: skip
    assert fs.Model(parts=parts, sea=fs.Sea(depth=20.0)).loose() == ["sinker"]
