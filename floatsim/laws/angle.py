"""Bending energy of the angle between two neighbouring elements, U = k theta^2 / 2.

Written in the cosine c = t_a . t_b so that force and tangent have no singular case at theta = 0:

    f(c) = theta^2/2,   f' = -theta/sin(theta),   f'' = (sin(theta) - theta cos(theta)) / sin(theta)^3
"""

import math

from floatsim.jit import kernel


@kernel
def half_angle_squared(c, y):  # type: ignore[no-untyped-def]
    """(f', f'') from cosine c and squared sine y of the angle.

    Below sin(theta) = 0.1 theta/sin(theta) is the series of arcsin(s)/s to s^12 (1e-14), which spares the arctangent
    that costs as much as the rest of a bent pair; below 0.02 f'' is its own series (1e-11).
    """
    if y < 0.01 and c > 0.0:
        q = 1.0 + y * (1 / 6 + y * (3 / 40 + y * (5 / 112 + y * (35 / 1152 + y * (63 / 2816 + y * (231 / 13312))))))
        if y < 0.0004:
            x = y * q * q
            return -q, 1.0 / 3.0 + x * (2.0 / 15.0 + 2.0 / 63.0 * x)
        return -q, (1.0 - q * c) / y
    s = math.sqrt(y)
    theta = math.atan2(s, c)
    return -theta / s, (s - theta * c) / (s * y)
