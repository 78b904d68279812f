"""The rotor as two states and a surface: performance, controller, operating points."""
