"""Axial and bending laws of a cable section: one law, one file.

A law is a scalar kernel; the element kernel of `floatsim.parts.line` calls it once per element.
"""
