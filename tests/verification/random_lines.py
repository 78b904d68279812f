"""Set-ups of lines as engineers have them, drawn at random: what statics must find the equilibrium of."""

from __future__ import annotations

import numpy as np

import floatsim as fs

RHO, G = 1025.0, 9.81


def section(name, wet, dry, EA, EI=0.0, drag=0.0):
    """Section of given weights per metre in water and in air [N/m]."""
    return fs.Section(name=name, mass_per_length=dry / G, diameter=fs.diameter_from_weights(dry, wet, RHO, G), EA=EA,
                      EI=EI, drag_normal=drag, drag_tangential=0.02 * drag)  # fmt: skip


def between(rng, low, high):
    """Evenly distributed in the logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def draw_section(rng, kind, drag):
    """A chain, wire, polyester rope, cable or buoyant hose."""
    if kind == "chain":
        d = rng.uniform(0.05, 0.16)  # bar diameter; studless: 19.9 t/m3 d2, 8.54e10 d2 N
        return section("chain", 0.87 * 19.9e3 * d * d * G, 19.9e3 * d * d * G, 8.54e10 * d * d, drag=drag)
    if kind == "wire":
        d = rng.uniform(0.05, 0.14)
        return section("wire", 3.0e3 * d * d * G, 4.0e3 * d * d * G, 4.0e10 * d * d, rng.choice([0.0, 1e9 * d**4]),
                       drag)
    if kind == "polyester":
        d = rng.uniform(0.08, 0.25)
        return section("polyester", 0.2e3 * d * d * G, 0.8e3 * d * d * G, 1.1e9 * d * d * rng.uniform(1.0, 3.0), 0.0,
                       drag)
    dry = between(rng, 100.0, 1200.0)
    EI = rng.choice([0.0, between(rng, 1e2, 1e5)], p=[0.15, 0.85])
    if kind == "buoyant":
        return section("hose", -rng.uniform(0.05, 0.5) * dry, dry, between(rng, 1e7, 1e9), EI, drag)
    return section("cable", rng.uniform(0.3, 0.7) * dry, dry, between(rng, 1e8, 1e9), EI, drag)


def draw_current(rng, depth):
    """None for half of the sites, else uniform, a power law or a table that turns."""
    kind = rng.choice(["none", "uniform", "power", "table"], p=[0.5, 0.2, 0.15, 0.15])
    speed, heading = float(rng.uniform(0.2, 1.2)), float(rng.uniform(0.0, 360.0))
    if kind == "none":
        return fs.Current(speed=0.0)
    if kind == "table":
        return fs.Current.table(depths=(0.0, 0.3 * depth, depth), speeds=(speed, 0.6 * speed, 0.1 * speed),
                                headings_deg=(heading, heading + 40.0, heading + 90.0))  # fmt: skip
    return fs.Current(speed=speed, heading_deg=heading, profile=fs.PowerLaw() if kind == "power" else None)


def counted(rng, length):
    """Number of elements of 0.5 to 8 m, 10 to 250 in all (longer elements where that does not do)."""
    n = length / between(rng, 0.5, 8.0)
    return int(np.clip(n, 10, 250))


def slackness(rng):
    """Length over span: taut, as usual, slack."""
    return float(rng.choice([rng.uniform(1.0005, 1.01), rng.uniform(1.01, 1.3), rng.uniform(1.3, 2.0)]))


def end_joint(rng, end, at, clamped, direction):
    """A hinge, or a clamp that leaves within some 30 degrees of `direction`."""
    if not clamped:
        return fs.Ball(a=end, b=tuple(at))
    return fs.Clamp(a=end, b=tuple(at), direction=tuple(direction + 0.5 * rng.uniform(-1.0, 1.0, 3)))


def catenary(rng):
    """One section from an anchor on the bed to a fairlead, any direction in plan; a few with a sloping bed."""
    depth = between(rng, 30.0, 2000.0)
    drag = 1.2
    kind = rng.choice(["chain", "wire", "polyester", "cable"])
    X, heading = between(rng, 0.05, 4.0) * depth, rng.uniform(0.0, 2.0 * np.pi)
    slope = tuple(rng.uniform(-0.1, 0.1, 2)) if rng.random() < 0.15 else (0.0, 0.0)
    top = np.array([0.0, 0.0, -rng.uniform(0.0, 0.3) * depth])
    low = np.array([X * np.cos(heading), X * np.sin(heading), 0.0])
    low[2] = -depth + slope[0] * low[0] + slope[1] * low[1]
    if low[2] > top[2]:
        slope, low[2] = (0.0, 0.0), -depth
    length = slackness(rng) * float(np.linalg.norm(top - low))
    line = fs.Line(name="line", section=draw_section(rng, kind, drag), length=length, elements=counted(rng, length))
    clamped = line.pieces[0].section.EI > 0.0 and rng.random() < 0.3
    joints = [fs.Ball(a="line.end_a", b=tuple(low)), end_joint(rng, "line.end_b", top, clamped, np.array([0, 0, -1.0]))]
    return fs.Model(parts=[line], joints=joints,
                    sea=fs.Sea(depth=depth, current=draw_current(rng, depth),
                               seabed=fs.Seabed(slope=slope)))  # fmt: skip


def between_bodies(rng):
    """A cable hanging in a U between two floaters, some clamped; some lie on the bed."""
    depth, X = between(rng, 40.0, 1000.0), between(rng, 20.0, 600.0)
    a = np.array([0.0, 0.0, -rng.uniform(0.0, 20.0)])
    b = np.array([X, 0.3 * X * rng.uniform(-1, 1), -rng.uniform(0.0, 20.0)])
    length = slackness(rng) * float(np.linalg.norm(b - a))
    sec = draw_section(rng, rng.choice(["cable", "chain", "buoyant"], p=[0.6, 0.2, 0.2]), 1.2)
    clamped = sec.EI > 0.0 and rng.random() < 0.4
    line = fs.Line(name="line", section=sec, length=length, elements=counted(rng, length))
    way = np.array([0.0, 0.0, -1.0])
    joints = [end_joint(rng, "line.end_a", a, clamped, way), end_joint(rng, "line.end_b", b, clamped, way)]
    return fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=depth, current=draw_current(rng, depth)))


def buoyant(rng):
    """A hose lighter than water, from the bed to a point below or at the surface."""
    depth = between(rng, 30.0, 500.0)
    X = between(rng, 0.1, 3.0) * depth
    low, top = np.array([X, 0.2 * X * rng.uniform(-1, 1), -depth]), np.array([0.0, 0.0, -rng.uniform(0.0, 0.5) * depth])
    length = slackness(rng) * float(np.linalg.norm(top - low))
    line = fs.Line(name="line", section=draw_section(rng, "buoyant", 1.2), length=length, elements=counted(rng, length))
    joints = [fs.Ball(a="line.end_a", b=tuple(low)), fs.Ball(a="line.end_b", b=tuple(top))]
    return fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=depth, current=draw_current(rng, depth)))


def wave(rng, steep=False):
    """A lazy wave of three sections, or a steep one (its lower section short and pulled taut); any first shape."""
    depth = between(rng, 50.0, 400.0)
    dry, EI = between(rng, 200.0, 1200.0), rng.choice([0.0, between(rng, 1e2, 1e5)], p=[0.1, 0.9])
    wet, EA = rng.uniform(0.3, 0.7) * dry, between(rng, 1e8, 1e9)
    shares = (0.25, rng.uniform(0.15, 0.3))
    ratio, X = rng.uniform(2.4, 3.2), depth * rng.uniform(1.0, 2.2)
    if steep:
        shares, ratio, X = (0.5, rng.uniform(0.25, 0.35)), rng.uniform(1.6, 2.2), depth * rng.uniform(0.4, 1.0)
    total = ratio * depth
    pull = -wet * rng.uniform(0.4, 1.2) * (3.0 if steep else 1.0)
    plain = section("cable", wet, dry, EA, EI, 1.2)
    floating = section("buoyant", pull, 1.6 * dry, EA, EI, 1.2)
    lengths = np.array([*shares, 1.0 - sum(shares)]) * total
    n = counted(rng, total)
    pieces = [fs.Piece(section=s, length=float(y), elements=max(1, round(n * y / total)))
              for s, y in zip((plain, floating, plain), lengths, strict=True)]  # fmt: skip
    shape = None
    if not steep:
        shape = (None, fs.ThreeCircles(), fs.Catenary(), fs.Straight())[rng.integers(4)]
    anchor = np.array([X, 0.1 * X * rng.uniform(-1, 1) * rng.integers(2), -depth])
    top = np.array([0.0, 0.0, -rng.uniform(0.0, 0.1) * depth])
    line = fs.Line(name="line", pieces=pieces, shape=shape)
    clamped = EI > 0.0 and rng.random() < 0.4
    joints = [end_joint(rng, "line.end_a", top, clamped, np.array([0.3, 0.0, -1.0])),
              end_joint(rng, "line.end_b", anchor, EI > 0.0 and steep and rng.random() < 0.5, np.array([0, 0, 1.0]))]
    return fs.Model(parts=[line], joints=joints, sea=fs.Sea(depth=depth, current=draw_current(rng, depth)))


def random_set_up(rng):
    """(kind, model or None, why it was refused) of one of the above."""
    kind = rng.choice(["catenary", "wave", "steep", "bodies", "buoyant"], p=[0.35, 0.35, 0.1, 0.12, 0.08])
    build = {"catenary": catenary, "wave": wave, "steep": lambda r: wave(r, steep=True), "bodies": between_bodies,
             "buoyant": buoyant}[kind]  # fmt: skip
    try:
        return str(kind), fs.assemble(build(rng)), ""
    except fs.ModelError as error:
        return str(kind), None, str(error)


def weight(system):
    """Largest of the weight in air and its excess buoyancy over all lines [N]."""
    total = 0.0
    for part in system.model.parts:
        if isinstance(part, fs.Line):
            total += float(np.abs(part.wet_weight(RHO, G)) @ part.element_lengths)
    return total
