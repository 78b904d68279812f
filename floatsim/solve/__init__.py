"""Linear solve, Newton steps in time, static equilibrium, natural modes. Knows no part, joint or law."""
