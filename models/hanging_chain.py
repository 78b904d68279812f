"""A chain hung between two fixed points in the air: the smallest model with a line.

At rest it is a catenary: with half span 40 m and length 100 m, a = 33.82 m solves sinh(40/a) = 50/a and the
horizontal tension is w a (closed form).
"""

import floatsim as fs


def build(span: float = 80.0, length: float = 100.0, elements: int = 40) -> fs.Model:
    """span [m] between the ends, unstretched length [m], number of elements."""
    chain = fs.Section(name="chain", mass_per_length=50.0, diameter=0.05, EA=2.0e8)
    line = fs.Line(name="chain", section=chain, length=length, elements=elements)
    return fs.Model(
        name="hanging_chain",
        parts=[line],
        joints=[
            fs.Ball(a="chain.end_a", b=(-span / 2.0, 0.0, 60.0)),
            fs.Ball(a="chain.end_b", b=(span / 2.0, 0.0, 60.0)),
        ],
        sea=fs.Sea(depth=50.0),
    )
