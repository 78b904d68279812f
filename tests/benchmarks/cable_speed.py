"""Cables side by side with MoorDyn and CableDyn: CPU seconds per simulated second, and the accuracy bought with them.

    pip install -e .[bench]
    python tests/benchmarks/cable_speed.py [--case still waves chains] [--rounds 3]

Three cases: the power umbilical of models/umbilical_rm3.py under its benchmark motion in still water, the same in an
irregular sea of 200 components, and the three chains of VolturnUS-S with that motion at their fairleads. One process,
one thread. Every setting runs once per round, one after the other (A B C, A B C, ...), and its best round counts:
another process on the machine then hits all of them alike. Time is CPU time of the stepping only: reading, statics
and compilation are reported apart. Without the extra `bench` only floatsim runs.

Accuracy, over 60..120 s, samples every 0.1 s: mean, standard deviation and extremes of the force on the support at the
top (chains: at fairlead 1), the largest curvature, and the rms of the force's difference to a converged run *of the
same code* as a share of the mean, so that nobody is measured against somebody else's model.

How the settings of the peers correspond:

  drag           all three: 0.5 rho d Cd_n |v_n| v_n and 0.5 rho pi d Cd_t |v_t| v_t per length. The same numbers.
  axial damping  floatsim and CableDyn: 0.005 s EA = 3.755 MN s. MoorDyn is explicit: this is above its limit of
                 stability by an order of magnitude. It gets the share of critical damping it is stable with
                 (-1, at RK2 dt 2.5e-4 -0.3); waves along the cable of 10 Hz and more are all that feels it.
  sections       floatsim and CableDyn: one line, bending continuous. MoorDyn: three lines joined by free points, which
                 transmit no moment.
  seabed         1e5 Pa/m and 1e4 Pa s/m (CableDyn's defaults), chains 3e6 and 3e5 (the public deck); no friction.
                 The peers' dampers switch on at contact, that of floatsim grows with penetration.
  motion         floatsim and CableDyn: position, velocity and acceleration at every step. MoorDyn: position at every
                 call and the mean velocity to the next, every 0.1 to 0.5 ms (midpoint 1 ms, chains 5 ms). With the
                 velocity of the moment it would run off by h^2/2 times the acceleration until the next call sets it
                 back, and EA/l0 makes a kilonewton of that at h = 2 ms.
  stepping       CableDyn through its own driver: called from Python, version 0.3 steps cables with bending to a
                 tolerance of 5e-3, which is not good enough at 0.1 s, and does not know waves. The cost of reading and
                 of statics is that of a run of one step.
  waves          one set of components for all. MoorDyn: WaveKin 3 (its grid in space and time, filled before the run)
                 and WaveKin 7 (its exact sum), both with the whole depth stretched to the surface.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np  # noqa: E402

import floatsim as fs  # noqa: E402

MODELS = Path(__file__).resolve().parents[2] / "models"
sys.path.insert(0, str(MODELS))

import umbilical_rm3 as umbilical  # noqa: E402
import volturnus_s as volturnus  # noqa: E402

DURATION, FROM, INTERVAL = 120.0, 60.0, 0.1  # s: simulated, first second that counts, between samples
Point = tuple[float, float, float]


@dataclass
class Signal:
    """Force on the support [N] and largest curvature [1/m], (n,) each, every `interval` s, the first after one."""

    force: np.ndarray
    curvature: np.ndarray
    interval: float = INTERVAL

    def late(self, interval: float | None = None) -> Signal:
        """From 60 s on; with an `interval`, only every so often."""
        every = 1 if interval is None else round(interval / self.interval)
        first = round(FROM / self.interval) - 1
        return Signal(self.force[first::every], self.curvature[first::every], self.interval * every)


@dataclass
class Entry:
    """One row of the table. run(duration) gives (CPU seconds of the stepping, CPU seconds before it, signal)."""

    code: str
    setting: str
    run: Callable[[float], tuple[float, float, Signal]]
    reference: bool = False  # the converged run of its code: accuracy only
    duration: float = DURATION
    cost: float = math.inf
    start: float = math.inf
    signal: Signal | None = field(default=None, repr=False)

    def measure(self) -> None:
        """One round."""
        cost, start, signal = self.run(self.duration)
        self.cost, self.start = min(self.cost, cost / self.duration), min(self.start, start)
        self.signal = signal if self.duration == DURATION else None


class Chains:
    """The three chains of VolturnUS-S, their fairleads moving like the umbilical's hang-off."""

    names = ("mooring_1", "mooring_2", "mooring_3")

    @staticmethod
    def model(elements: int = 50) -> fs.Model:
        section = volturnus.chain()
        parts: list[Any] = []
        joints: list[Any] = []
        for name, fairlead, anchor in zip(Chains.names, volturnus.FAIRLEADS, volturnus.ANCHORS, strict=True):
            parts.append(fs.Line(name=name, section=section, length=volturnus.CHAIN_LENGTH, elements=elements))
            joints.append(fs.Ball(a=f"{name}.end_a", b=anchor))
            motion = umbilical.benchmark_motion(fairlead)
            joints.append(fs.Prescribed(a=f"{name}.end_b", motion=motion, name=f"fairlead_{name[-1]}"))
        # the peers' dampers act fully at once: here from the chain's penetration at rest, 6 mm, on
        bed = fs.Seabed(stiffness=3e6, damping=3e5, damping_penetration=0.006)
        sea = fs.Sea(depth=200.0, density=volturnus.DENSITY, seabed=bed)
        return fs.Model(name="chains", parts=parts, joints=joints, sea=sea, gravity=volturnus.GRAVITY)


def samples(motion: fs.Motion, t: float) -> tuple[list[float], ...]:
    """Position, velocity and acceleration as lists."""
    return tuple(values.tolist() for values in motion.translation(t))


# --- floatsim ---------------------------------------------------------------------------------------


class Floatsim:
    """Runs a model with a fixed output interval; compiled and at rest before anything is timed."""

    def __init__(self, model: fs.Model, force: str, curvature: str | None) -> None:
        began = time.process_time()
        self.system = fs.assemble(model)
        self.state, _ = fs.solve_static(self.system)
        self.force, self.curvature = force, curvature
        self._simulate(INTERVAL, INTERVAL)  # compiles
        self.first = time.process_time() - began

    def _simulate(self, duration: float, dt: float, *extra: str) -> fs.Run:
        channels = [self.force, *extra]
        every = max(dt, INTERVAL)
        run = fs.simulate(self.system, duration, dt, state=self.state, interval=every, channels=channels)
        if run.status != "done":
            raise SystemExit(f"floatsim failed: {run.failure}")
        return run

    def at(self, dt: float) -> Callable[[float], tuple[float, float, Signal]]:
        """Run with step dt. Set-up of a run is taken off as the time of a run of one output."""

        def run(duration: float) -> tuple[float, float, Signal]:
            began = time.process_time()
            self._simulate(max(dt, INTERVAL), dt)
            middle = time.process_time()
            self._simulate(duration, dt)
            ended = time.process_time()
            extra = () if self.curvature is None else (self.curvature,)
            result = self._simulate(duration, dt, *extra)
            force = np.linalg.norm(result.series(self.force)[1:], axis=1)
            bent = np.zeros(len(force)) if self.curvature is None else result.series(self.curvature)[1:].max(axis=1)
            return ended - middle - (middle - began), self.first, Signal(force, bent, max(dt, INTERVAL))

        return run


# --- MoorDyn ----------------------------------------------------------------------------------------


@dataclass
class Deck:
    """What both peers read: types, points and lines of a case, in MoorDyn's order."""

    types: list[tuple[str, fs.Section]]
    moving: list[Point]  # coupled points, numbered from 1
    fixed: list[Point]
    free: list[Point]  # joints between sections, for MoorDyn
    lines: list[tuple[str, int, int, float, int]]  # type, end points, length, elements, for MoorDyn
    depth: float
    seabed: tuple[float, float]
    waves: Any = None  # a floatsim Realisation


def umbilical_deck(model: fs.Model, waves: Any) -> Deck:
    """The umbilical's joints are placed where floatsim finds them at rest; MoorDyn relaxes from there."""
    system = fs.assemble(model)
    state, _ = fs.solve_static(system)
    (line,) = (part for part in model.parts if isinstance(part, fs.Line))
    nodes = fs.simulate(system, INTERVAL, INTERVAL, state=state, channels=["umbilical_position"])
    x = nodes.series("umbilical_position")[0]
    ends = np.cumsum([piece.elements for piece in line.pieces])
    types = {piece.section.name: piece.section for piece in line.pieces}
    numbers = [1, 3, 4, 2]  # hang-off, the two joints, anchor
    lines = [
        (piece.section.name, numbers[k + 1], numbers[k], piece.length, piece.elements)
        for k, piece in enumerate(line.pieces)
    ]
    joints = [(float(x[n, 0]), float(x[n, 1]), float(x[n, 2])) for n in ends[:-1]]
    return Deck(list(types.items()), [umbilical.HANG_OFF], [umbilical.ANCHOR], joints, lines,
                umbilical.DEPTH, umbilical.SEABED, waves)  # fmt: skip


def chains_deck() -> Deck:
    lines = [("chain", 4 + k, 1 + k, volturnus.CHAIN_LENGTH, 50) for k in range(3)]
    return Deck([("chain", volturnus.chain())], list(volturnus.FAIRLEADS), list(volturnus.ANCHORS), [], lines,
                200.0, (3e6, 3e5))  # fmt: skip


def wave_files(folder: Path, waves: Any, phase: float, grid: bool) -> None:
    """Components (WaveKin 7, which sums sines: `phase` is added) and, for the grid, the elevation at x = 0."""
    rows = ["0 0 0 0"]
    for a, w, p, b in zip(waves.amplitude, waves.omega, waves.phase, waves.heading, strict=True):
        rows.append(f"{w:.12g} {a * math.cos(p + phase):.12g} {a * math.sin(p + phase):.12g} {b:.12g}")
    (folder / "wave_frequencies.txt").write_text("\n".join(rows) + "\n")
    if grid:
        t = np.arange(0.0, DURATION + 40.0, 0.1)
        eta = np.cos(waves.omega * t[:, None] + waves.phase) @ waves.amplitude
        np.savetxt(folder / "wave_elevation.txt", np.column_stack([t, eta]), fmt="%.10g")
        # x, y, z of the grid: 2 is `from, to, number of points`, 0 is the origin alone
        axes = "2\n-12 112 32\n0\n0\n2\n-70 6 39\n"
        (folder / "water_grid.txt").write_text(f"water grid\n\n\n{axes}")


@contextmanager
def silence() -> Iterator[None]:
    """MoorDyn writes a banner to the process's own stdout and stderr."""
    sys.stdout.flush()
    kept = [(n, os.dup(n)) for n in (1, 2)]
    with open(os.devnull, "w") as nowhere:
        for n, _ in kept:
            os.dup2(nowhere.fileno(), n)
    try:
        yield
    finally:
        for n, copy in kept:
            os.dup2(copy, n)
            os.close(copy)


class MoorDyn:
    """One setting of MoorDyn-C, called from Python."""

    def __init__(self, deck: Deck, motions: list[fs.Motion], scheme: str, dt: float, call: float, damping: float,
                 wave_kin: int = 0) -> None:  # fmt: skip
        self.deck, self.motions, self.scheme, self.dt, self.call = deck, motions, scheme, dt, call
        self.damping, self.wave_kin = damping, wave_kin

    def text(self) -> str:
        d = self.deck
        types = [
            f"{name} {s.diameter} {s.mass_per_length} {s.EA} {-self.damping} {s.EI} {s.drag_normal} "
            f"{s.added_mass_normal} {s.drag_tangential} {s.added_mass_tangential}"
            for name, s in d.types
        ]
        kinds = [("Coupled", d.moving), ("Fixed", d.fixed), ("Free", d.free)]
        points = [(kind, p) for kind, group in kinds for p in group]
        options = {
            "writeLog": 0, "disableOutTime": 1, "tScheme": self.scheme, "dtM": self.dt, "g": umbilical.GRAVITY,
            "rhoW": umbilical.DENSITY, "WtrDpth": d.depth, "kBot": d.seabed[0], "cBot": d.seabed[1], "dtIC": 1.0,
            "TmaxIC": 60.0, "CdScaleIC": 5.0, "threshIC": 1e-4, "WaveKin": self.wave_kin, "dtWave": 0.1,
        }  # fmt: skip
        return "\n".join([
            "--- MoorDyn", "umbilical or chains",
            "--- LINE TYPES ---", "Name Diam Mass EA BA EI Cd Ca CdAx CaAx", "- - - - - - - - - -", *types,
            "--- POINTS ---", "ID Type X Y Z Mass Vol CdA Ca", "- - - - - - - - -",
            *(f"{k} {kind} {p[0]} {p[1]} {p[2]} 0 0 0 0" for k, (kind, p) in enumerate(points, 1)),
            "--- LINES ---", "ID Type A B Length Segments Outputs", "- - - - - - -",
            *(f"{k} {t} {a} {b} {length} {n} -" for k, (t, a, b, length, n) in enumerate(d.lines, 1)),
            "--- OPTIONS ---", *(f"{value} {name}" for name, value in options.items()),
            "--- need this line ---", "",
        ])  # fmt: skip

    def __call__(self, duration: float) -> tuple[float, float, Signal]:
        import moordyn

        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            if self.deck.waves is not None:
                wave_files(folder, self.deck.waves, 0.5 * math.pi, self.wave_kin == 3)
            (folder / "deck.txt").write_text(self.text())
            p, v = self._motion(0.0)
            began = time.process_time()
            with silence():
                system = moordyn.Create(str(folder / "deck.txt"))
                moordyn.Init(system, p, v)
            start = time.process_time() - began
            lines = [moordyn.GetLine(system, k + 1) for k in range(len(self.deck.lines))]
            bending = self.deck.types[0][1].EI > 0.0
            calls, cost = round(INTERVAL / self.call), 0.0
            force, curvature = [], []
            for j in range(round(duration / INTERVAL)):
                moments = [j * INTERVAL + i * self.call for i in range(calls)]
                feed = [(*self._motion(t), t) for t in moments]
                began = time.process_time()
                for p, v, t in feed:
                    f = moordyn.Step(system, p, v, t, self.call)
                cost += time.process_time() - began
                if not all(math.isfinite(y) for y in f):
                    raise RuntimeError(f"force is not a number at {(j + 1) * INTERVAL:g} s")
                force.append(math.hypot(*f[:3]))
                curvature.append(
                    max(moordyn.GetLineNodeCurv(line, i) for line, row in zip(lines, self.deck.lines, strict=True)
                        for i in range(row[4] + 1)) if bending else 0.0
                )  # fmt: skip
            moordyn.Close(system)
        return cost, start, Signal(np.array(force), np.array(curvature))

    def _motion(self, t: float) -> tuple[list[float], list[float]]:
        now, then = ([x for motion in self.motions for x in samples(motion, t + h)[0]] for h in (0.0, self.call))
        return now, [(b - a) / self.call for a, b in zip(now, then, strict=True)]


# --- CableDyn ---------------------------------------------------------------------------------------


class CableDyn:
    """One setting of CableDyn, through its driver: its CPU time less that of a run of one step."""

    def __init__(self, deck: Deck, motions: list[fs.Motion], dt: float) -> None:
        self.deck, self.motions, self.dt = deck, motions, dt

    def write(self, folder: Path, duration: float, outputs: list[str]) -> None:
        from cabledyn.builder import DeckModel

        d = self.deck
        model = DeckModel.new(title="umbilical or chains", path=folder / "deck.dat")
        for name, s in d.types:
            # a negative axial damping is a share of critical
            ratio = s.axial_damping_ratio
            damping = s.axial_damping if ratio is None else -ratio
            model.add_line_type(
                name, diam=s.diameter, mass=s.mass_per_length, ea=s.EA, ba=damping, ei=s.EI, cdn=s.drag_normal,
                cdt=s.drag_tangential, can=s.added_mass_normal, cat=s.added_mass_tangential,
            )  # fmt: skip
        for k, p in enumerate(d.moving, 1):
            model.add_point(k, "Coupled", *p)
        for k, p in enumerate(d.fixed, 1 + len(d.moving)):
            model.add_point(k, "Fixed", *p)
        if d.free:
            line = model.add_line(1, 1, 2)
            for name, _, _, length, n in d.lines:
                model.add_section(line, name, length, n)
            for end in "AB":
                model.add_end_connection(line, end, "Pinned", (0.0, 0.0, 1.0))
        else:
            for k, (name, a, b, length, n) in enumerate(d.lines, 1):
                model.add_line(k, b, a, name, length=length, num_segs=n)
        options = {"g": umbilical.GRAVITY, "rhoW": umbilical.DENSITY, "WtrDpth": d.depth, "kBot": d.seabed[0],
                   "cBot": d.seabed[1], "dtM": self.dt, "TMax": duration, "motionFile": "motion.txt"}  # fmt: skip
        for name, value in options.items():
            model.options.set(name, value)
        if d.waves is not None:
            wave_files(folder, d.waves, 0.5 * math.pi, False)
            model.options.set("WaveKin", 7)
        with (folder / "motion.txt").open("w") as file:
            for j in range(round(duration / self.dt) + 1):
                for k, motion in enumerate(self.motions, 1):
                    row = np.concatenate(samples(motion, j * self.dt))
                    file.write(f"{j * self.dt:.9g} {k} " + " ".join(f"{y:.15g}" for y in row) + "\n")
        model.outputs.add(*outputs)
        model.save(folder / "deck.dat")

    def drive(self, duration: float, outputs: list[str]) -> tuple[float, np.ndarray]:
        """CPU seconds of the driver's process, and its table, (n, columns)."""
        import resource

        from cabledyn.driver import bundled_driver

        def children() -> float:
            used = resource.getrusage(resource.RUSAGE_CHILDREN)
            return used.ru_utime + used.ru_stime

        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            self.write(folder, duration, outputs)
            began = children()
            command = [str(bundled_driver()), "deck.dat", "out"]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode:
                raise RuntimeError(done.stderr.strip().splitlines()[-1])
            return children() - began, np.loadtxt(folder / "out.out", skiprows=2, ndmin=2)

    def __call__(self, duration: float) -> tuple[float, float, Signal]:
        forces = ["Point1Fx", "Point1Fy", "Point1Fz"]
        cost, _ = self.drive(duration, forces)
        start, _ = self.drive(self.dt, forces)
        nodes = sum(row[4] for row in self.deck.lines) + 1
        curvatures = [f"Curv1N{k}" for k in range(1, nodes)] if self.deck.free else []
        table = self.drive(duration, forces + curvatures)[1][round(INTERVAL / self.dt) :: round(INTERVAL / self.dt)]
        bent = np.abs(table[:, 4:]).max(axis=1) if curvatures else np.zeros(len(table))
        return cost - start, start, Signal(np.linalg.norm(table[:, 1:4], axis=1), bent)


# --- the table --------------------------------------------------------------------------------------


def entries(case: str, peers: bool) -> list[Entry]:
    """All settings of a case, floatsim at 0.1 s first."""
    waves = umbilical.storm().realise(umbilical.DEPTH, umbilical.GRAVITY) if case == "waves" else None
    if case == "chains":
        own = Floatsim(Chains.model(), "fairlead_1_force", None)
        fine = Floatsim(Chains.model(400), "fairlead_1_force", None)
        motions = [umbilical.benchmark_motion(place) for place in volturnus.FAIRLEADS]
    else:
        # no ramp: MoorDyn's waves have none, and 60 s are enough to forget the start
        model = umbilical.build(waves=None if waves is None else "storm", wave_ramp=0.0)
        own = Floatsim(model, "hang_off_force", "umbilical_curvature")
        model = umbilical.build(4.0, waves=None if waves is None else "storm", wave_ramp=0.0)
        fine = Floatsim(model, "hang_off_force", "umbilical_curvature")
        motions = [umbilical.benchmark_motion()]
    rows = [Entry("floatsim", f"dt {dt:g}", own.at(dt)) for dt in (0.1, 0.05, 0.2)]
    rows.append(Entry("floatsim", "dt 0.0125", own.at(0.0125), reference=True))
    rows.append(Entry(FINE, "dt 0.0125", fine.at(0.0125), reference=True))
    if not peers:
        return rows
    deck = chains_deck() if case == "chains" else umbilical_deck(umbilical.build(), waves)

    def moordyn(
        setting: str, scheme: str, dt: float, call: float, damping: float, kin: int = 0, **options: Any
    ) -> None:
        rows.append(Entry("MoorDyn", setting, MoorDyn(deck, motions, scheme, dt, call, damping, kin), **options))

    if case == "chains":
        moordyn("RK2 dt 5e-3", "rk2", 5e-3, 5e-3, 1.0)
        moordyn("RK2 dt 5e-4", "rk2", 5e-4, 5e-3, 1.0, reference=True)
    elif case == "still":
        moordyn("Midpoint5 dt 1e-3", "midpoint5", 1e-3, 1e-3, 1.0)
        moordyn("RK2 dt 2.5e-4", "rk2", 2.5e-4, 5e-4, 0.3)
        moordyn("RK2 dt 1e-4", "rk2", 1e-4, 2e-4, 1.0)
        moordyn("RK2 dt 5e-5", "rk2", 5e-5, 1e-4, 1.0, reference=True)
    else:
        moordyn("grid, Midpoint5 1e-3", "midpoint5", 1e-3, 1e-3, 1.0, 3)
        moordyn("grid, RK2 2.5e-4", "rk2", 2.5e-4, 5e-4, 0.3, 3)
        moordyn("exact, Midpoint5 1e-3", "midpoint5", 1e-3, 1e-3, 1.0, 7, duration=1.0)
        moordyn("grid, RK2 1e-4", "rk2", 1e-4, 2e-4, 1.0, 3, reference=True)
    rows += [Entry("CableDyn", f"dt {dt:g}", CableDyn(deck, motions, dt)) for dt in (0.1, 0.05)]
    rows.append(Entry("CableDyn", "dt 0.0125", CableDyn(deck, motions, 0.0125), reference=True))
    return rows


FINE = "fine"  # floatsim with four (chains: eight) times the elements
HEAD = (
    f"{'code':9s}{'setting':23s}{'CPU s/s':>10s}{'ratio':>8s}{'start s':>9s}"
    f"{'mean kN':>10s}{'std':>8s}{'max':>10s}{'min':>10s}{'1/m':>8s}{'to own':>10s}{'to fine':>10s}"
)


def row(entry: Entry, first: Entry, references: dict[str, Signal]) -> str:
    """One line of the table."""
    cost = f"{'reference':>18s}" if entry.reference else f"{entry.cost:10.5f}{entry.cost / first.cost:8.1f}"
    text = f"{entry.code:9s}{entry.setting:23s}{cost}{entry.start:9.2f}"
    if entry.signal is None:
        return f"{text}   cost from {entry.duration:g} s"
    late = entry.signal.late()
    force = late.force / 1e3
    text += f"{force.mean():10.3f}{force.std():8.3f}{force.max():10.3f}{force.min():10.3f}"
    text += f"{late.curvature.max():8.4f}" if late.curvature.any() else f"{'-':>8s}"
    for code in (entry.code, FINE):
        if code not in references or code == entry.code and entry.reference:
            text += f"{'-':>10s}"
            continue
        exact = references[code].late(entry.signal.interval).force / 1e3
        text += f"{100.0 * np.sqrt(np.mean((force - exact) ** 2)) / exact.mean():9.3f}%"
    return text


def compare(case: str, title: str, rounds: int, peers: bool) -> None:
    """Measure one case and print its table."""
    rows = entries(case, peers)
    failed: list[str] = []
    for k in range(rounds):
        for entry in list(rows):
            if k and entry.reference:
                continue
            try:
                entry.measure()
            except (RuntimeError, ValueError) as error:
                failed.append(f"{entry.code} {entry.setting} fails: {error}")
                rows.remove(entry)
    references = {entry.code: entry.signal for entry in rows if entry.reference and entry.signal is not None}
    print(f"\n{title}\n{HEAD}")
    for entry in rows:
        print(row(entry, rows[0], references))
    print("\n".join(failed), flush=True)


TITLES = {
    "still": "Umbilical, 137 elements, benchmark motion, still water",
    "waves": "Umbilical, 137 elements, benchmark motion, JONSWAP Hs 8.25 m, Tp 14.5 s, 200 components",
    "chains": "VolturnUS-S, three chains of 50 elements, moving fairleads, still water; force of fairlead 1",
}


def main() -> None:
    parser = argparse.ArgumentParser(description="Cables side by side with MoorDyn and CableDyn")
    parser.add_argument("--case", nargs="+", choices=list(TITLES), default=list(TITLES))
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    try:
        import cabledyn
        import moordyn  # noqa: F401

        peers = True
        print(f"with CableDyn {cabledyn.__version__} and MoorDyn")
    except ImportError as error:
        peers = False
        print(f"{error.name} is not installed (extra `bench`): floatsim only")
    for case in options.case:
        compare(case, TITLES[case], options.rounds, peers)
    print("\nstart: CPU seconds before stepping (floatsim: assembly, statics, compilation or its cache)")


if __name__ == "__main__":
    main()
