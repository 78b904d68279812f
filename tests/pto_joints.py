"""Joints with coordinates that tests of PTOs put them on."""

from __future__ import annotations

from typing import Any

import numpy as np

import floatsim as fs
from floatsim.joints.constraints import Align, Coincide
from floatsim.joints.coordinates import JointCoordinates, Slide, Turn


def _frame(axis):
    """Axis and two normals, right-handed."""
    e = np.asarray(axis, dtype=float)
    e /= np.linalg.norm(e)
    n = np.cross(e, np.eye(3)[np.argmin(np.abs(e))])
    n /= np.linalg.norm(n)
    return e, n, np.cross(e, n)


class Loose(fs.Ball):
    """No constraint at all: only coordinates, a slide and a turn about `axis` (in b's frame at the drawing)."""

    axis: Any = (0.0, 0.0, 1.0)
    turns: bool = True

    def ties(self):
        return []

    def rows(self, place, attitude):
        return []

    def coordinates(self, place, attitude):
        a, b = place(self.a), place(self.b)
        e, n, _ = _frame(self.axis)
        there = {"slide": Slide(a, b, tuple(e))}
        if self.turns:
            R = [np.eye(3) if attitude(p.rotation) is None else attitude(p.rotation) for p in (a, b)]
            there["turn"] = Turn(a, b, tuple(e), tuple(R[0].T @ R[1] @ n), tuple(n))
        return there

    def children(self):
        return [JointCoordinates(name=f"{self.label}.coordinates", joint=self.label)]


class Pin(Loose):
    """A hinge about `axis`."""

    def rows(self, place, attitude):
        a, b = place(self.a), place(self.b)
        e, n, m = _frame(self.axis)
        R = [np.eye(3) if attitude(p.rotation) is None else attitude(p.rotation) for p in (a, b)]
        on_a = tuple(R[0].T @ R[1] @ e)
        return [Coincide(a, b), *(Align(a.rotation, on_a, b.rotation, tuple(y)) for y in (n, m))]

    def coordinates(self, place, attitude):
        return {"": super().coordinates(place, attitude)["turn"]}
