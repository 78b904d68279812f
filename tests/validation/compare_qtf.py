"""Full QTF of VolturnUS-S: the second-order force series against the double sum and the spectrum. Run by hand:

    python tests/validation/compare_qtf.py FOLDER

FOLDER holds IEA-15-240-RWT-UMaineSemi.12d, possibly gzipped (OpenFAST/IEA-15-240-RWT-UMaineSemi/HydroData of
github.com/IEAWindTask37/IEA-15-240-RWT, Apache-2.0). Exit status 1 if a bar is missed.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from second_order import band_variance, series, slow_variance  # noqa: E402

from floatsim.hydro.drift import Newman, PairSum  # noqa: E402
from floatsim.hydro.qtf import QTF, read_wamit_qtf  # noqa: E402
from floatsim.sea.spectra import Jonswap  # noqa: E402
from floatsim.sea.waves import IrregularWaves, Realisation, WaveComponents  # noqa: E402

SPECTRUM = Jonswap(hs=5.0, tp=10.0)
LOW, HIGH, SEEDS, DT = 0.02, 0.3, 100, 2.0  # rad/s, rad/s, -, s
DOFS = {"surge": 0, "heave": 2, "pitch": 4}


def irregular(seed: int, top: float) -> Realisation:
    return IrregularWaves(spectrum=SPECTRUM, seed=seed, omega_max=top).realise(200.0, 9.81)


def mean_drift(qtf: QTF, omega: np.ndarray) -> np.ndarray:
    """T(w, w) (n, 6), linear between the frequencies of the file."""
    known = np.diagonal(qtf.transfer[0]).real  # (6, p)
    return np.stack([np.interp(omega, qtf.omega, row) for row in known], axis=1)


def double_sum_error(qtf: QTF, top: float) -> float:
    """Largest relative difference from the direct double sum at some times."""
    sea = irregular(1, top)
    times = np.array([0.0, 0.3, 61.7, 1800.9, 3599.9])
    got = series(PairSum(qtf, sea, 0.0), sea, times)
    T = np.nan_to_num(qtf.matrix(sea.omega, 0.0))
    worst = 0.0
    for t, force in zip(times, got, strict=True):
        y = sea.amplitude * np.exp(1j * (sea.omega * t + sea.phase))
        exact = np.einsum("m,mnd,n->d", y, T, y.conj()).real
        worst = max(worst, *(abs(force[d] / exact[d] - 1.0) for d in DOFS.values()))
    return worst


def mean_error(qtf: QTF) -> float:
    """Waves at multiples of 0.01 rad/s: the mean over their common period against the sum of a^2 T(w, w)."""
    omega = 0.01 * np.arange(30, 150)
    phase = np.random.default_rng(2).uniform(0.0, 360.0, omega.size)
    a = 0.3 * np.sqrt(SPECTRUM.density(omega))
    sea = WaveComponents(amplitude=tuple(a), omega=tuple(omega), phase_deg=tuple(phase)).realise(200.0, 9.81)
    mean = series(PairSum(qtf, sea, 0.0), sea, np.arange(256) * 2.0 * np.pi / 0.01 / 256).mean(axis=0)
    exact = a**2 @ mean_drift(qtf, sea.omega)
    return max(abs(mean[d] / exact[d] - 1.0) for d in DOFS.values())


def bound_wave(qtf: QTF) -> tuple[float, float]:
    """Phases, deg, of surge and pitch, w2 = 0.7..0.9, w1 = w2 + 0.25 rad/s: where the second-order potential rules.

    The set-down -B cos(mu t - dk x) under a group pushes like a long wave: surge in proportion to minus its slope,
    sin(mu t), a phase of -90 deg; acting below the origin it gives a pitch moment of +90 deg. The other order of the
    two periods would turn both signs.
    """
    w = np.arange(0.7, 0.9, 0.01)
    T = qtf.matrix(np.concatenate([w, w + 0.25]), 0.0)[w.size :, : w.size]
    surge, pitch = (np.trace(T[..., d]) for d in (0, 4))
    return float(np.degrees(np.angle(surge))), float(np.degrees(np.angle(pitch)))


def main(folder: str) -> int:
    stem = Path(folder) / "IEA-15-240-RWT-UMaineSemi.12d"
    path = stem if stem.is_file() else stem.with_name(stem.name + ".gz")
    qtf = read_wamit_qtf(path, density=1025.0, gravity=9.81)
    top = float(qtf.omega[-1])
    print(f"{path.name}: {qtf.omega.size} frequencies, {qtf.omega[0]:.3g} to {top:.3g} rad/s; JONSWAP {SPECTRUM!r}")
    missed = 0
    for text, error in (("direct double sum", double_sum_error(qtf, top)), ("sum of a^2 T(w, w)", mean_error(qtf))):
        missed += error > 1e-6
        print(f"series against the {text:20s} {error:9.1e}  bar 1e-6{'   MISSED' if error > 1e-6 else ''}")

    surge, pitch = bound_wave(qtf)
    bad = not (surge < 0.0 < pitch)
    missed += bad
    print(f"phases at a difference of 0.25 rad/s: surge {surge:.0f} deg, pitch {pitch:.0f} deg; bound wave: -90, +90"
          f"{'   MISSED' if bad else ''}")  # fmt: skip
    exact = slow_variance(SPECTRUM, lambda w: np.nan_to_num(qtf.matrix(w, 0.0)), LOW, HIGH, 2.4, 0.005)
    first = irregular(0, top)  # amplitudes and frequencies are the same for all seeds
    forces = (PairSum(qtf, first, 0.0), Newman(mean_drift(qtf, first.omega), first))
    ratio = np.zeros((2, SEEDS, 6))
    for seed in range(SEEDS):
        sea = irregular(seed, top)
        for k, force in enumerate(forces):
            ratio[k, seed] = band_variance(series(force, sea, DT * np.arange(1800)), DT, LOW, HIGH) / exact
    print(f"variance over {LOW} to {HIGH} rad/s, mean of {SEEDS} one-hour seeds of {first.omega.size} waves,")
    print("over 8 int int S(w) S(w + mu) |T|^2 dw dmu:")
    print(f"{'':8s}{'full QTF':>10s}{'std error':>11s}{'bar':>8s}{'Newman':>10s}")
    for name, d in DOFS.items():
        full, newman = ratio[:, :, d].mean(axis=1)
        bad = abs(full - 1.0) > 0.02
        missed += bad
        spread = ratio[0, :, d].std() / np.sqrt(SEEDS)
        print(f"{name:8s}{full:10.4f}{spread:11.4f}{'2 %':>8s}{newman:10.3f}{'   MISSED' if bad else ''}")
    return 1 if missed else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
