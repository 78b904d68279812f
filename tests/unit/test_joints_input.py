"""Bad input of joints and locks."""

from __future__ import annotations

import re

import pytest

import floatsim as fs
from floatsim.joints.cylindrical import Cylindrical
from floatsim.joints.hinge import Hinge
from floatsim.joints.lock import Lock
from floatsim.joints.point_on_line import PointOnLine
from floatsim.joints.rod import Rod
from floatsim.joints.slider import Slider
from floatsim.joints.universal import Universal

SEA = fs.Sea(depth=50.0)
BODY = fs.Body(name="one", mass=1.0, inertia=(1, 1, 1), position=(0, 0, 9), points={"p": (0, 0, 1)})
OTHER = fs.Body(name="two", mass=1.0, inertia=(1, 1, 1), position=(0, 0, 10))
MASS = fs.PointMass(name="ball", mass=1.0, position=(0, 0, 10))
Z = (0.0, 0.0, 1.0)
HINGE = Hinge(a="one.p", b="two", axis=Z, name="hinge")


def assemble(joints, parts=(BODY, OTHER, MASS)):
    return fs.assemble(fs.Model(parts=list(parts), joints=joints, sea=SEA))


BAD = [
    (lambda: Hinge(a="one", b="two"), "Hinge: 'axis' is missing"),
    (lambda: Hinge(a="one", b="two", axis=(0, 0, 0)), "got (0, 0, 0); an axis needs a length"),
    (lambda: Slider(a="one", b="two", axis="z"), "axis: got 'z'; must be three finite numbers"),
    (lambda: Slider(a="one", b="two", axis=Z, zero=float("nan")), "zero: got nan; must be a finite number"),
    (lambda: Cylindrical(a="one", b="two", axis=Z, zero=1.0), "zero: got 1.0; must be two finite numbers"),
    (lambda: Universal(a="one", b="two", first=Z, second=(0, 1, 1)), "first and second are 45 deg apart"),
    (lambda: Rod(a="one", b="two", length=0.0), "length: got 0.0; must be a positive number"),
    (lambda: Lock(name="l", joint="hinge", latch_for=1.0, engage=(1.0,)), "exclude each other; give one of them"),
    (lambda: Lock(name="l", joint="hinge", engage=(1.0, 2.0), release=(2.0,)), "at the same time, t = 2 s"),
    (lambda: Lock(name="l", joint="hinge", controller=3), "must be a function (t, s, ds) -> True or False"),
    (lambda: Lock(name="l", joint="hinge", latch_for=-1.0), "latch_for: got -1.0; must be a positive number"),
]

WRONG = [
    ([Hinge(a="ball", b="one.p", axis=Z)], "Hinge 'ball_joint': 'ball' has no rotation"),
    ([Slider(a="one", b="ball", axis=Z, name="s")], "Slider 's': 'ball' has no rotation"),
    ([PointOnLine(a="one", b="ball", axis=Z, name="s")], "PointOnLine 's': 'ball' has no rotation"),
    ([Universal(a="one.p", b="ball", first=Z, second=(1, 0, 0), name="s")], "Universal 's': 'ball' has no rotation"),
    ([Rod(a="one.p", b="two", name="rod")], "Rod 'rod': its two ends start at the same place"),
    ([Rod(a="one", b="two", length=2.0, name="rod")], "length is 2 m, but its ends are drawn 1 m apart"),
    ([Hinge(a="one", b="two", axis=Z, name="h")], "joint 'h' is open by 1 m"),
    ([Slider(a="one", b="two", axis=(1, 0, 0), name="s")], "joint 's' is open by 1 m"),
    ([Rod(a="one", b="twoo", name="rod")], "there is no connection point 'twoo' (did you mean 'two'?)"),
    ([HINGE, fs.Weld(a="one.p", b="two", name="weld")], "joints are redundant"),
]


@pytest.mark.parametrize(("make", "says"), BAD)
def test_arguments(make, says):
    with pytest.raises(fs.ModelError, match=re.escape(says)):
        make()


@pytest.mark.parametrize(("joints", "says"), WRONG)
def test_models(joints, says):
    with pytest.raises(fs.ModelError, match=re.escape(says)):
        assemble(joints)


@pytest.mark.parametrize(("lock", "says"), [
    (Lock(name="l", joint="hing"), "there is no joint 'hing' with a coordinate (did you mean 'hinge'?)"),
    (Lock(name="l", joint="hinge", coordinate="turn"),
     "Lock 'l': joint 'hinge' has no coordinate 'turn'; it has only one, without a name"),
    (Lock(name="l", joint="post"), "joint 'post' has no coordinate ''; it has 'slide', 'turn'"),
])  # fmt: skip
def test_locks_of_nothing(lock, says):
    third = fs.Body(name="three", mass=1.0, inertia=(1, 1, 1), position=(0, 0, 20))
    post = Cylindrical(a="three", b="two", axis=Z, name="post")
    with pytest.raises(fs.ModelError, match=re.escape(says)):
        assemble([HINGE, post], [BODY, OTHER, third, lock])


def test_two_locks_of_one_coordinate():
    with pytest.raises(fs.ModelError, match="joints are redundant.*remove or loosen: '(first|second)'"):
        assemble([HINGE], [BODY, OTHER, Lock(name="first", joint="hinge"), Lock(name="second", joint="hinge")])


def test_lock_among_joints():
    with pytest.raises(fs.ModelError, match="joints: got Lock 'l'; this is a part"):
        assemble([HINGE, Lock(name="l", joint="hinge")])
