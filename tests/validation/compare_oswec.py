"""The decay of the OSWEC flap with floatsim's database and with public Capytaine coefficients. Run by hand:

    python tests/validation/compare_oswec.py FILE

FILE is HydroChrono's capytaine_oswec_hydrodynamics.nc (MIT; plain or .gz): the same device on WEC-Sim's surface by
Capytaine 2.3.1. It has no infinite frequency; that is found from the others (Ogilvie 1964). It shows how much of the
difference from WEC-Sim the database makes. Exit status 1 if an extremum is off by 2 % of 10 degrees or 1 % of the time.
"""

from __future__ import annotations

import gzip
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parent)]

import test_oswec as test  # noqa: E402

import floatsim as fs  # noqa: E402
from floatsim.study.decay import extrema  # noqa: E402

HIGHEST = 8.0  # rad/s


def public_database(path: Path, own: fs.HydroDatabase) -> fs.HydroDatabase:
    """The file's radiation and hydrostatics; no waves. Frequencies at which it has no numbers are left out."""
    import netCDF4

    data = path.read_bytes()
    memory = gzip.decompress(data) if path.suffix == ".gz" else data
    with netCDF4.Dataset("public", memory=memory) as file:
        omega = np.asarray(file["omega"][:])
        A, B = (np.asarray(file[name][:].filled(np.nan)) for name in ("added_mass", "radiation_damping"))
        C = np.asarray(file["hydrostatic_stiffness"][:])
        displaced = float(file["inertia_matrix"][0, 0])  # the file's mass is that of the displaced water
    keep = np.isfinite(A).all(axis=(1, 2)) & (omega <= HIGHEST)
    omega, A, B = omega[keep], *(0.5 * (m + m.swapaxes(1, 2))[keep] for m in (A, B))
    tau, low = np.arange(0.0, 40.0, 0.05), (omega > 0.8) & (omega < 3.0)
    kernel = 2.0 / np.pi * np.trapezoid(np.cos(np.outer(tau, omega))[..., None, None] * B, omega, axis=1)
    sine = np.sin(np.outer(omega[low], tau))[..., None, None]
    infinite = A[low] + np.trapezoid(sine * kernel, tau, axis=1) / omega[low, None, None]
    volume = own.volume.copy()
    volume[0] = displaced / test.oswec.DENSITY
    return fs.HydroDatabase(
        name="public", bodies=own.bodies, omega=omega, added_mass=A, radiation_damping=B,
        added_mass_inf=infinite.mean(axis=0), headings=np.zeros(1), excitation=np.zeros((omega.size, 1, 12)),
        hydrostatic_stiffness=C, volume=volume, centre_of_buoyancy=own.centre_of_buoyancy,
        reference_point=own.reference_point, depth=own.depth, density=own.density, gravity=own.gravity,
    )  # fmt: skip


def main(path: Path) -> int:
    own = fs.HydroDatabase.read(test.oswec.HYDRO)
    public = public_database(path, own)
    print("turning about the hinge; public, own")
    print(f"{'rad/s':>6s} {'added mass [1e6 kg m2]':>24s} {'damping [1e6 N m s/rad]':>26s}")
    for omega in (0.2, 0.325, 0.5, 0.65, 0.8, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0):
        (A, B), (A_own, B_own) = public.at(omega), own.at(omega)
        numbers = [test.hinged(m) / 1e6 for m in (A, A_own, B, B_own)]
        print("{:6.3f} {:12.3f} {:11.3f} {:14.4f} {:11.4f}".format(omega, *numbers))
    missed = 0
    print(f"\n{'extremum':10s} {'own database':>24s} {'public coefficients':>26s}   time [%], pitch [% of 10 deg]")
    found = [extrema(*test.decay(hydro=hydro), 0.0) for hydro in (own, public)]
    for k, (time, angle) in enumerate(test.EXTREMA, 1):
        off = [(100.0 * (t[k] / time - 1.0), 10.0 * (x[k] - angle)) for t, x in found]
        missed += any(abs(dt) > 1.0 or abs(dx) > 2.0 for dt, dx in off)
        print("{:<10d} {:15.2f} {:8.2f} {:17.2f} {:8.2f}".format(k, *off[0], *off[1]))
    return int(missed > 0)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1])))
