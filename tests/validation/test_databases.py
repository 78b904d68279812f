"""Our own hydrodynamic databases (models/*_hydro.nc, by Capytaine) against numbers published by others.

Errors are the largest difference over the table as a share of the largest published value of the entry.

Sources: Hulme, J. Fluid Mech. 121 (1982) 443, the floating hemisphere (exact series); WAMIT runs of the OES Task 10
sphere, of RM3 and of the ellipsoid that come with WEC-Sim (Apache-2.0), OSWEC by Capytaine 2.3 (source formulation)
that comes with HydroChrono, F3OF of the WEC3 comparison (MIT). Tables in SI units, A kg, B N s/m, X N/m or N m/m.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from floatsim.hydro.check import check_database
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.meshing import triangles

MODELS = Path(__file__).parents[2] / "models"
OURS = ("sphere_oes", "sphere_kramer", "rm3", "oswec", "ellipsoid", "f3of", "waves4power")

# ka, A33 / (2/3 pi rho a3), B33 / (2/3 pi rho a3 omega)
HULME = np.array([
    (0.05, 0.8764, 0.1036), (0.1, 0.8627, 0.1816), (0.2, 0.7938, 0.2793), (0.3, 0.7157, 0.3254), (0.4, 0.6452, 0.3410),
    (0.5, 0.5861, 0.3391), (0.6, 0.5381, 0.3271), (0.7, 0.4999, 0.3098), (0.8, 0.4698, 0.2899), (0.9, 0.4464, 0.2691),
    (1.0, 0.4284, 0.2484), (1.2, 0.4047, 0.2096), (1.4, 0.3924, 0.1756), (1.6, 0.3871, 0.1469), (1.8, 0.3864, 0.1229),
    (2.0, 0.3884, 0.1031), (2.5, 0.3988, 0.0674), (3.0, 0.4111, 0.0452), (4.0, 0.4322, 0.0219), (5.0, 0.4471, 0.0116),
    (6.0, 0.4574, 0.0066), (7.0, 0.4647, 0.0040), (8.0, 0.4700, 0.0026), (9.0, 0.4740, 0.0017), (10.0, 0.4771, 0.0012),
])  # fmt: skip

# omega, A11, B11, A33, B33, |X1|, |X3|: WAMIT, deep water
OES = np.array([
    (0.5, 1.3867e5, 290.56, 2.2169e5, 28163, 93693, 6.5222e5),
    (0.8, 1.554e5, 6734, 1.8224e5, 69471, 2.2287e5, 5.0615e5),
    (1.1, 1.7267e5, 46349, 1.3902e5, 93441, 3.6264e5, 3.6407e5),
    (1.4, 1.5035e5, 1.2936e5, 1.122e5, 91118, 4.2194e5, 2.5039e5),
    (1.7, 98846, 1.7926e5, 1.0204e5, 73249, 3.7121e5, 1.6778e5),
    (2.0, 63766, 1.7638e5, 1.0182e5, 52212, 2.8856e5, 1.11e5),
    (2.5, 43975, 1.3556e5, 1.0875e5, 25722, 1.8102e5, 55746),
    (3.0, 43222, 96598, 1.1559e5, 11824, 1.1626e5, 28749),
])  # fmt: skip

# the same entries of the ellipsoid 5 x 5 x 2.5 m: WAMIT, 70 m of water
ELLIPSOID = np.array([
    (0.506708, 42524, 62.813, 2.6676e5, 28785, 44140, 6.6807e5),
    (0.785398, 46324, 1167.2, 2.363e5, 76757, 95449, 5.4724e5),
    (1.122, 52134, 10397, 1.8414e5, 1.2206e5, 1.6667e5, 4.0373e5),
    (1.428, 50248, 31765, 1.4856e5, 1.3777e5, 2.029e5, 2.9873e5),
    (1.74533, 39016, 53395, 1.2697e5, 1.3317e5, 1.947e5, 2.1733e5),
    (1.9635, 30846, 61141, 1.1922e5, 1.2258e5, 1.7461e5, 1.7474e5),
    (2.61799, 16821, 60763, 1.1513e5, 80695, 1.1306e5, 92035),
    (3.14159, 13260, 51881, 1.1986e5, 52377, 79428, 56324),
])  # fmt: skip

# omega, A33, B33 float; A33, B33 spar; A, B float-spar heave; |X1|, |X3| float, |X3| spar: WAMIT
RM3 = np.array([
    (0.3, 2.084e6, 94864, 9.0287e6, 1989.5, -4.4602e5, -13741, 95200, 2.5756e6, 3.7391e5),
    (0.5, 1.899e6, 3.1587e5, 9.0552e6, 45011, -4.4246e5, -1.1923e5, 2.5498e5, 2.1841e6, 8.2581e5),
    (0.7, 1.5751e6, 5.283e5, 8.9593e6, 1.1496e5, -2.5017e5, -2.4657e5, 4.613e5, 1.705e6, 7.9693e5),
    (0.8, 1.4265e6, 5.9527e5, 8.9014e6, 1.2072e5, -1.4868e5, -2.6806e5, 5.605e5, 1.4812e6, 6.6799e5),
    (1.0, 1.2e6, 6.4883e5, 8.8508e6, 79173, -30723, -2.2665e5, 6.8944e5, 1.1063e6, 3.8702e5),
    (1.3, 1.0218e6, 5.7496e5, 8.8718e6, 21779, -23073, -1.119e5, 6.6428e5, 7.0233e5, 1.369e5),
    (1.6, 9.823e5, 4.0986e5, 8.8913e6, 6316.1, -60393, -50880, 5.3049e5, 4.3402e5, 53942),
    (2.0, 1.0275e6, 2.0422e5, 8.9062e6, 1943, -93009, -19920, 3.6901e5, 2.1897e5, 21354),
])  # fmt: skip

# omega; A, B, |X| of the flap's rotation about its hinge, 5 m below its centre of mass: Capytaine 2.3
OSWEC = np.array([
    (0.28, 5.5345e7, 4.6906e5, 3.6452e6), (0.48, 6.0484e7, 2.9905e6, 6.6653e6), (0.68, 6.6317e7, 1.1492e7, 1.0114e7),
    (0.88, 6.5642e7, 3.2436e7, 1.3383e7), (1.08, 4.6581e7, 5.9845e7, 1.4393e7), (1.4, 1.1152e7, 6.5493e7, 1.0712e7),
    (1.8, 2.6541e6, 4.2628e7, 6.5382e6), (2.4, 5.5779e6, 2.6948e7, 4.5531e6),
])  # fmt: skip

# omega; base A11; fore flap A11, B11 and about its hinge A55, B55; |X1| base, |X1|, |X5| fore flap (about its hinge)
F3OF = np.array([
    (0.2, 5.4202e5, 1.6862e6, 14.267, 4.1231e7, 294.15, 58266, 84403, 3.8249e5),
    (0.4, 5.5098e5, 1.7606e6, 1795, 4.3312e7, 38198, 2.1578e5, 3.3163e5, 1.5281e6),
    (0.6, 5.649e5, 1.9333e6, 29875, 4.8116e7, 6.7115e5, 4.0955e5, 7.2908e5, 3.4521e6),
    (0.8, 5.5405e5, 2.2831e6, 2.5942e5, 5.8148e7, 6.2691e6, 4.8454e5, 1.5068e6, 7.3986e6),
    (1.0, 5.2477e5, 1.8716e6, 1.188e6, 5.011e7, 3.129e7, 3.2963e5, 2.6643e6, 1.3668e7),
    (1.2, 5.5489e5, 1.9138e6, 9.0165e5, 5.3575e7, 2.6199e7, 79727, 9.871e5, 5.3397e6),
    (1.6, 5.535e5, 8.9518e5, 7.0307e5, 2.3084e7, 2.5251e7, 3.6976e5, 9.9955e5, 5.9985e6),
    (2.0, 4.8841e5, 1.0799e6, 6.4327e5, 2.9532e7, 2.7917e7, 1.4403e5, 5.6977e5, 3.7573e6),
])  # fmt: skip


def load(name: str) -> HydroDatabase:
    return HydroDatabase.read(MODELS / f"{name}_hydro.nc")


def of(values: np.ndarray, db: HydroDatabase, omega: np.ndarray) -> np.ndarray:
    return CubicSpline(db.omega, values)(omega)


def error(ours: np.ndarray, theirs: np.ndarray) -> float:
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def entries(db: HydroDatabase, i: int, j: int, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return of(db.added_mass[:, i, j], db, omega), of(db.radiation_damping[:, i, j], db, omega)


def force(db: HydroDatabase, omega: np.ndarray, arm: dict[int, float]) -> np.ndarray:
    """|sum arm_i X_i| at heading 0."""
    X = db.excitation[:, int(np.argmin(np.abs(db.headings)))]
    return np.abs(of(sum(factor * X[:, i] for i, factor in arm.items()), db, omega))


def turned(matrices: np.ndarray, arm: dict[int, float]) -> np.ndarray:
    """v^T M v of the motion v with the components of `arm`."""
    v = np.zeros(matrices.shape[-1])
    v[list(arm)] = list(arm.values())
    return np.einsum("i,nij,j->n", v, matrices, v)


@pytest.mark.parametrize("name", OURS)
def test_shipped_databases_are_consistent_small_and_carry_their_hull(name):
    path = MODELS / f"{name}_hydro.nc"
    db = HydroDatabase.read(path)
    errors = [finding.message for finding in check_database(db) if finding.severity == "error"]
    assert not errors
    assert path.stat().st_size < 0.5e6
    assert db.froude_krylov is not None and db.hull_vertices is not None and db.hull_vertices[:, 2].max() < 1e-6
    assert str(db.source["mesh_hash"]).startswith("sha256:") and str(db.source["solver"]).startswith("Capytaine 3")


@pytest.mark.parametrize("name", OURS)
def test_heave_excitation_in_long_waves_is_the_waterplane(name):
    # X3 -> rho g A_wp; checked at the lowest frequency with its own inertia taken off (Newman 1977)
    db = load(name)
    for body in range(len(db.bodies)):
        i = 6 * body + 2
        C, w = db.hydrostatic_stiffness[i, i], db.omega[0]
        if C > 0.0:
            wanted = C - w**2 * (db.density * db.volume[body] + db.added_mass[0, i, 2::6].sum())
            assert abs(db.excitation[0, 0, i] / wanted - 1.0) < 0.03


@pytest.mark.parametrize("name", [name for name in OURS if name != "f3of"])  # which has four headings
def test_damping_is_the_energy_that_excitation_says_is_radiated(record, name):
    # B = k / (8 pi rho g c_g) int X X* d(heading) (Newman, Marine Hydrodynamics, 1977)
    db = load(name)
    g, h = db.gravity, db.depth
    k = db.omega**2 / g
    for _ in range(200):
        k = db.omega**2 / (g * np.tanh(k * h))
    twice = 2.0 * np.minimum(k * h, 300.0)
    group = 0.5 * db.omega / k * (1.0 + twice / np.sinh(twice))
    X = db.excitation
    energy = np.einsum("nmi,nmj->nij", X, X.conj()).real * (2.0 * np.pi / db.headings.size)
    radiated = (k / (8.0 * np.pi * db.density * g * group))[:, None, None] * energy
    peak = np.abs(np.diagonal(db.radiation_damping, axis1=1, axis2=2)).max(axis=0).reshape(-1, 2, 3)
    # rotations that hardly make waves (yaw of bodies of revolution) are measured by what translations would
    arm = db.volume ** (2.0 / 3.0)
    peak[:, 1] = np.maximum(peak[:, 1], 0.05 * (peak[:, 0].max(axis=1) * arm)[:, None])
    scale = np.sqrt(peak.reshape(-1))
    difference = (db.radiation_damping - radiated) / np.outer(scale, scale)
    # as far as the headings resolve the pattern of the waves, which has k r harmonics
    fine = k * np.linalg.norm(db.hull_vertices[:, :2], axis=1).max() < 0.4 * db.headings.size
    rms = float(np.sqrt((difference[fine] ** 2).mean(axis=0)).max())
    record("Databases: damping and radiated energy", f"{name}, worst entry, rms / peak", rms, 0.02)


@pytest.mark.parametrize("name", OURS)
def test_froude_krylov_force_is_the_pressure_of_the_incident_wave_on_the_hull(name):
    # p = rho g cosh k(z + h) / cosh kh e^{-i k x} for the time factor e^{+i w t}, over the mesh in the file
    db = load(name)
    h = min(db.depth, 1e4)
    ahead = int(np.argmin(np.abs(db.headings)))
    mesh = (db.hull_vertices, db.hull_faces)
    owner = np.zeros(len(db.hull_faces), dtype=int) if db.hull_body is None else db.hull_body
    tri = triangles(mesh)
    x = 0.5 * (tri + np.roll(tri, -1, axis=1)).reshape(-1, 3)  # mid-edges, three per triangle
    area = np.repeat(np.cross(tri[:, 1] - tri[:, 0], tri[:, 2] - tri[:, 0]) / 6.0, 3, axis=0)
    owner = np.tile(owner, 2).repeat(3)  # all first, then all second triangles of the faces
    for index in (db.omega.size // 8, db.omega.size // 3):
        k = db.omega[index] ** 2 / db.gravity
        for _ in range(300):
            k = db.omega[index] ** 2 / (db.gravity * np.tanh(k * h))
        decay = (np.exp(k * x[:, 2]) + np.exp(-k * (x[:, 2] + 2.0 * h))) / (1.0 + np.exp(-2.0 * k * h))
        load_of = -(db.density * db.gravity * decay * np.exp(-1j * k * x[:, 0]))[:, None] * area
        for body in range(len(db.bodies)):
            mine = owner == body
            moment = np.cross(x[mine] - db.reference_point[body], load_of[mine])
            wanted = np.concatenate([load_of[mine].sum(axis=0), moment.sum(axis=0)])
            got = db.froude_krylov[index, ahead, 6 * body : 6 * body + 6]
            size = np.abs(wanted).reshape(2, 3).max(axis=1).repeat(3)
            size[3:] = np.maximum(size[3:], 0.1 * size[0] * db.volume[body] ** (1.0 / 3.0))
            assert np.all(np.abs(got - wanted) < 0.02 * size), db.bodies[body]  # one point a panel in the database


def test_hemisphere_by_hulme(record):
    db = load("sphere_oes")
    ka, mass, damping = HULME.T
    omega, unit = np.sqrt(ka * db.gravity / 5.0), 2.0 / 3.0 * np.pi * db.density * 5.0**3
    A, B = entries(db, 2, 2, omega)
    label = "Hemisphere, Hulme 1982"
    record(label, "added mass in heave, error / peak", error(A / unit, mass), 0.01)
    record(label, "damping in heave, error / peak", error(B / unit / omega, damping), 0.01)
    record(label, "added mass at infinite frequency / exact", db.added_mass_inf[2, 2] / unit / 0.5, (0.99, 1.01))


def test_kramer_sphere_at_frequencies_that_do_not_feel_the_bottom(record):
    # depth six radii: tanh(k h) > 0.999 from ka = 0.65
    db = load("sphere_kramer")
    ka, mass, damping = HULME[(HULME[:, 0] > 0.65) & (HULME[:, 0] < 9.0)].T
    omega, unit = np.sqrt(ka * db.gravity / 0.15), 2.0 / 3.0 * np.pi * db.density * 0.15**3
    A, B = entries(db, 2, 2, omega)
    peak, label = HULME[:, 1:].max(axis=0), "Kramer sphere, Hulme 1982"
    record(label, "added mass in heave, error / peak", np.abs(A / unit - mass).max() / peak[0], 0.01)
    record(label, "damping in heave, error / peak", np.abs(B / unit / omega - damping).max() / peak[1], 0.01)


@pytest.mark.parametrize(("name", "table", "label"), [
    ("sphere_oes", OES, "OES sphere by WAMIT"), ("ellipsoid", ELLIPSOID, "Ellipsoid by WAMIT"),
])  # fmt: skip
def test_single_bodies_by_wamit(record, name, table, label):
    db = load(name)
    omega = table[:, 0]
    for i, dof in ((0, "surge"), (2, "heave")):
        A, B = entries(db, i, i, omega)
        record(label, f"added mass in {dof}, error / peak", error(A, table[:, 1 + i]), 0.02)
        record(label, f"damping in {dof}, error / peak", error(B, table[:, 2 + i]), 0.02)
        X = force(db, omega, {i: 1.0})
        record(label, f"excitation in {dof}, error / peak", error(X, table[:, 5 + i // 2]), 0.02)


def test_two_bodies_of_rm3_by_wamit(record):
    db = load("rm3")
    omega = RM3[:, 0]
    for column, i, j, dof in ((1, 2, 2, "float"), (3, 8, 8, "spar"), (5, 2, 8, "float-spar")):
        A, B = entries(db, i, j, omega)
        record("RM3 by WAMIT", f"added mass in heave, {dof}, error / peak", error(A, RM3[:, column]), 0.03)
        record("RM3 by WAMIT", f"damping in heave, {dof}, error / peak", error(B, RM3[:, column + 1]), 0.03)
    for column, i, dof in ((7, 0, "surge, float"), (8, 2, "heave, float"), (9, 8, "heave, spar")):
        X = force(db, omega, {i: 1.0})
        record("RM3 by WAMIT", f"excitation in {dof}, error / peak", error(X, RM3[:, column]), 0.03)


def test_flap_of_the_oswec_by_capytaine_2(record):
    db = load("oswec")
    omega, arm = OSWEC[:, 0], {0: 5.0, 4: 1.0}
    label = "OSWEC by Capytaine 2.3, rotation about the hinge"
    mass, damping = (of(turned(c, arm), db, omega) for c in (db.added_mass, db.radiation_damping))
    record(label, "added mass, error / peak", error(mass, OSWEC[:, 1]), 0.05)
    record(label, "damping, error / peak", error(damping, OSWEC[:, 2]), 0.05)
    record(label, "excitation, error / peak", error(force(db, omega, arm), OSWEC[:, 3]), 0.05)


def test_flap_of_the_f3of(record):
    db = load("f3of")
    omega, label = F3OF[:, 0], "F3OF of the WEC3 comparison"
    arm = {6: 3.5, 10: 1.0}  # the hinge is 3.5 m below the flap's centre of mass
    A, B = entries(db, 6, 6, omega)
    record(label, "added mass in surge, flap, error / peak", error(A, F3OF[:, 2]), 0.05)
    record(label, "damping in surge, flap, error / peak", error(B, F3OF[:, 3]), 0.05)
    mass, damping = (of(turned(c, arm), db, omega) for c in (db.added_mass, db.radiation_damping))
    record(label, "added mass about the hinge, error / peak", error(mass, F3OF[:, 4]), 0.05)
    record(label, "damping about the hinge, error / peak", error(damping, F3OF[:, 5]), 0.05)
    record(label, "excitation in surge, flap, error / peak", error(force(db, omega, {6: 1.0}), F3OF[:, 7]), 0.05)
    record(label, "excitation about the hinge, error / peak", error(force(db, omega, arm), F3OF[:, 8]), 0.05)
    # boxes of the same section push more water aside than octagons
    record(label, "added mass in surge, base, error / peak", error(entries(db, 0, 0, omega)[0], F3OF[:, 1]), 0.15)
    record(label, "excitation in surge, base, error / peak", error(force(db, omega, {0: 1.0}), F3OF[:, 6]), 0.10)
