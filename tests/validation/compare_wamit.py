"""VolturnUS-S with WAMIT's public coefficients against OpenFAST, every tolerance halved. Run by hand:

    python tests/validation/compare_wamit.py FOLDER

FOLDER holds IEA-15-240-RWT-UMaineSemi.1, .3 and .hst (OpenFAST/IEA-15-240-RWT-UMaineSemi/HydroData of
github.com/IEAWindTask37/IEA-15-240-RWT, Apache-2.0). Exit status 1 if a bar is missed.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from openfast_volturnus import DECK_CM_Z, OFFSET, decay_rows, static_rows  # noqa: E402
from shipped import load  # noqa: E402

import floatsim as fs  # noqa: E402

STEM = "IEA-15-240-RWT-UMaineSemi"
SHARE = 0.5  # of the tolerances that floatsim's own database has to meet


def main(folder: str) -> int:
    volturnus_s = load("volturnus_s")
    hydro = fs.read_wamit(
        Path(folder) / STEM, depth=200.0, density=volturnus_s.DENSITY, gravity=volturnus_s.GRAVITY,
        volume=volturnus_s.VOLUME, centre_of_buoyancy=(0.0, 0.0, -13.627908),
    )  # fmt: skip
    model = volturnus_s.build(platform_cm_z=DECK_CM_Z, hydro=hydro)
    rows = static_rows(model) + [row for dof in OFFSET for row in decay_rows(model, dof)]
    print(f"{'quantity':34s} {'floatsim':>12s} {'OpenFAST':>12s} {'':4s} {'difference':>10s} {'bar':>6s}")
    missed = 0
    for row in rows:
        bad = row.difference > SHARE * row.bar
        missed += bad
        print(
            f"{row.quantity:34s} {row.value:12.6g} {row.reference:12.6g} {row.unit:4s} {row.difference:10.2g} "
            f"{SHARE * row.bar:6.3g} {row.measure}{'   MISSED' if bad else ''}"
        )
    print(f"{len(rows)} quantities, {missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
