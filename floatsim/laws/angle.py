"""Bending energy of the angle between two neighbouring elements, U = k theta^2 / 2.

Written in the cosine c = t_a . t_b so that force and tangent have no singular case at theta = 0:

    f(c) = theta^2/2,   f' = -theta/sin(theta),   f'' = (sin(theta) - theta cos(theta)) / sin(theta)^3
"""

import math

from floatsim.jit import kernel


@kernel
def half_angle_squared(c, s):  # type: ignore[no-untyped-def]
    """(theta, f', f'') from cosine c and sine s >= 0 of the angle.

    Below s = 0.1 theta/s is the series of arcsin(s)/s to s^12 (1e-14), which spares the arctangent that costs as much
    as the rest of a bent pair; below 0.02 f'' is its own series in theta (1e-11).
    """
    if s < 0.1 and c > 0.0:
        y = s * s
        q = 1.0 + y * (1 / 6 + y * (3 / 40 + y * (5 / 112 + y * (35 / 1152 + y * (63 / 2816 + y * (231 / 13312))))))
        theta = s * q
        if s < 0.02:
            x = theta * theta
            return theta, -q, 1.0 / 3.0 + x * (2.0 / 15.0 + 2.0 / 63.0 * x)
        return theta, -q, (1.0 - q * c) / y
    theta = math.atan2(s, c)
    return theta, -theta / s, (s - theta * c) / (s * s * s)
