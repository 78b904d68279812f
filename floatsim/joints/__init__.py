"""Joints by Lagrange multipliers. A joint is declared as rows of two primitives (`constraints.py`):
points that coincide and axes that stay normal to each other."""
