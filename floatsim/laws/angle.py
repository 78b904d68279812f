"""Bending energy of the angle between two neighbouring elements, U = k theta^2 / 2.

Written in the cosine c = t_a . t_b so that force and tangent have no singular case at theta = 0:

    f(c) = theta^2/2,   f' = -theta/sin(theta),   f'' = (sin(theta) - theta cos(theta)) / sin(theta)^3
"""

import math

from floatsim.jit import kernel


@kernel
def half_angle_squared(c, s):  # type: ignore[no-untyped-def]
    """(theta, f', f'') from cosine c and sine s >= 0 of the angle. Series below 0.02 rad: 1e-11."""
    theta = math.atan2(s, c)
    if s < 0.02 and c > 0.0:
        x = theta * theta
        return theta, -(1.0 + x / 6.0 + 7.0 * x * x / 360.0), 1.0 / 3.0 + x * (2.0 / 15.0 + 2.0 / 63.0 * x)
    return theta, -theta / s, (s - theta * c) / (s * s * s)
