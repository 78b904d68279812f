"""F3OF, test DT1, with floatsim's database and with a participant's coefficients. Run by hand:

    python tests/validation/compare_f3of.py FOLDER

FOLDER holds the participants' series, PDS_F3OF_DT1_SURGE.dat.gz and so on, and the coefficients in hdb_PDS/, as
HydroChrono publishes them for its F3OF decay demo (MIT). Only surge is taken from the coefficients: on its slider and
with its flaps locked the device does nothing else, and the file of the base's added mass at infinite frequency holds
the flap's. That is found from the others (Ogilvie 1964). Exit status 1 if a period is off by more than 2 %.
"""

from __future__ import annotations

import gzip
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from shipped import load  # noqa: E402

import floatsim as fs  # noqa: E402
from floatsim.study.decay import fit_decay  # noqa: E402

f3of = load("f3of")
PARTICIPANTS = ("INW", "PDS", "WDN")
HIGHEST = 6.0  # rad/s


def rows(path: Path) -> np.ndarray:
    """The numbers of a table, in the order of its first column."""
    found = []
    for line in gzip.decompress(path.read_bytes()).decode().splitlines():
        try:
            found.append([float(word) for word in line.split()])
        except ValueError:  # a heading
            continue
    table = np.array([row for row in found if row])
    return np.asarray(table[np.argsort(table[:, 0])])


def surge_database(folder: Path, own: fs.HydroDatabase) -> fs.HydroDatabase:
    """Surge of the three bodies by the participant PDS in a database of 18 degrees of freedom, else as our own."""
    A, B = {}, {}
    for i in range(3):
        for j in range(3):
            for store, kind in ((A, "Maij"), (B, "Bij")):
                table = rows(folder / f"{kind}_Body{i}Body{j}.dat.gz")
                table = table[(table[:, 0] > 0.0) & (table[:, 0] <= HIGHEST)]
                store[i, j], omega = table[:, 1], table[:, 0]
    surge = [0, 6, 12]
    mass, damping = (np.array([[store[i, j] for j in range(3)] for i in range(3)]) for store in (A, B))
    mass, damping = (0.5 * (m + m.swapaxes(0, 1)) for m in (mass, damping))  # (3, 3, n)
    tau = np.arange(0.0, 200.0, 0.05)
    kernel = 2.0 / np.pi * np.trapezoid(damping[..., None, :] * np.cos(np.outer(tau, omega)), omega, axis=-1)
    low = (omega > 0.1) & (omega < 0.5)
    sine = np.sin(np.outer(omega[low], tau))
    infinite = mass[..., low] + np.trapezoid(kernel[..., None, :] * sine, tau, axis=-1) / omega[low]
    print(f"added mass at infinite frequency from A(0.1 to 0.5 rad/s): scatter {infinite.std(axis=-1).max():.3g} kg")
    added, radiated = np.zeros((2, omega.size, 18, 18))
    at_infinity = np.zeros((18, 18))
    for i in range(3):
        for j in range(3):
            added[:, surge[i], surge[j]], radiated[:, surge[i], surge[j]] = mass[i, j], damping[i, j]
            at_infinity[surge[i], surge[j]] = infinite[i, j].mean()
    return fs.HydroDatabase(
        name="PDS", bodies=own.bodies, omega=omega, added_mass=added, radiation_damping=radiated,
        added_mass_inf=at_infinity, headings=np.zeros(1), excitation=np.zeros((omega.size, 1, 18)),
        hydrostatic_stiffness=own.hydrostatic_stiffness, volume=own.volume, centre_of_buoyancy=own.centre_of_buoyancy,
        reference_point=own.reference_point, depth=own.depth, density=own.density, gravity=own.gravity,
    )  # fmt: skip


def main(folder: Path) -> int:
    own = fs.HydroDatabase.read(f3of.HYDRO)
    theirs = surge_database(folder / "hdb_PDS", own)
    print(f"\n{'rad/s':>6s} {'surge added mass of all [t]':>29s} {'surge damping of a flap [t/s]':>31s}")
    every = np.tile([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 3)
    for omega in (0.1, 0.3, 0.5, 0.8, 1.0, 1.2, 1.3, 1.4, 1.6, 1.7, 1.8, 2.0, 2.5, 3.0):
        pairs = [db.at(omega) for db in (theirs, own)]
        a, b = [every @ A @ every / 1e3 for A, _ in pairs], [B[6, 6] / 1e3 for _, B in pairs]
        print(f"{omega:6.2f} {a[0]:14.1f} {a[1]:14.1f} {b[0]:15.1f} {b[1]:15.1f}")
    print(f"\n{'period of surge [s]':30s} {'each cycle':s}")
    bad = 0
    series = {name: rows(folder / f"{name}_F3OF_DT1_SURGE.dat.gz")[:1700, :2].T for name in PARTICIPANTS}
    for name, hydro in (("floatsim, own database", own), ("floatsim, database of PDS", theirs)):
        test = fs.decay_test(f3of.build(hydro=hydro), "surge", 5.0, body="base", duration=165.0)
        series[name] = np.array([test.run.time, test.run.series("base_position")[:, 0]])
    periods = {}
    for name, (t, x) in series.items():
        fit = fit_decay(t, x, 0.0)
        periods[name] = fit.period
        print(f"{name:30s} {np.array2string(fit.periods, precision=3)}  crests {np.round(fit.value[::2], 3)}")
    band = [periods[name] for name in PARTICIPANTS]
    for name in list(periods)[3:]:
        bad += not 0.98 * min(band) <= periods[name] <= 1.02 * max(band)
    return int(bad > 0)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1])))
