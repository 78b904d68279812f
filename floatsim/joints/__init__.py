"""Joints by Lagrange multipliers. A joint is declared as rows of four primitives (`constraints.py`):
points that coincide, axes that stay normal to each other, points in planes, points at a distance."""
