"""Axial and bending laws of a cable section: one law, one file.

The two linear axial laws are scalar kernels that the element kernel calls (the rows of `LINEAR`). Every other law runs
over all its elements before it: an object with `stiffness` [N], `memory` (rows), `bind(damping)` -> function
(s, rate, old, new, h, out) and `start(s)`; see tension_table.py for the shortest. A law of a user's own script works
the same way.
"""
