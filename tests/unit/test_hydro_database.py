"""The hydrodynamic database: its file, its checks, and the one shipped for VolturnUS-S."""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import netCDF4
import numpy as np
import pytest
import xarray as xr

from floatsim.errors import ModelError
from floatsim.hydro.check import check_database
from floatsim.hydro.database import (
    HydroDatabase,
    added_mass_from_damping,
    require_match,
)
from floatsim.hydro.meshing import mesh_hash
from floatsim.sea.dispersion import wave_number

MODELS = Path(__file__).parents[2] / "models"
SHIPPED = MODELS / "volturnus_s_hydro.nc"


def lorentzian(omega: np.ndarray, a: float = 0.2, b: float = 0.7) -> tuple[np.ndarray, np.ndarray]:
    """A(w) - A_inf and B(w) of the kernel K(t) = e^{-a t} (cos b t - a/b sin b t).

    Its Laplace transform s / ((s + a)^2 + b^2) at s = i w is B(w) + i w (A(w) - A_inf); B(0) = 0 and B >= 0.
    """
    transform = 1j * omega / ((1j * omega + a) ** 2 + b**2)
    return transform.imag / omega, transform.real


def consistent(**changes: Any) -> HydroDatabase:
    """A made-up floater that obeys every law: kernels above, long-wave heave, headings around the circle."""
    rho, g, volume = 1000.0, 9.81, 8000.0
    omega = changes.pop("omega", 0.05 * np.arange(1, 61))
    length = np.array([1.0, 1.0, 1.0, 20.0, 20.0, 20.0])
    size = (
        rho
        * volume
        * np.outer(length, length)
        * (np.eye(6) + np.diag([0.2, 0.1], 4) + np.diag([0.2, 0.1], -4))
    )
    delta, damping = lorentzian(omega)
    mass = size + 0.3 * delta[:, None, None] * size
    stiffness = np.diag([0.0, 0.0, rho * g * 400.0, 2e9, 2e9, 0.0])
    headings = np.radians(np.arange(-180.0, 180.0, 10.0))
    force = np.zeros((omega.size, headings.size, 6), dtype=complex)
    force[:, :, 2] = (stiffness[2, 2] - omega**2 * (rho * volume + mass[:, 2, 2]))[:, None]
    # a body in long waves is pushed by (rho V + A) times the water's acceleration at its centre of buoyancy
    k = wave_number(omega, 200.0, g)
    water = 1j * g * k * np.cosh(k * 190.0) / np.cosh(k * 200.0)
    for i, along in enumerate((np.cos(headings), np.sin(headings))):
        force[:, :, i] = (water * (rho * volume + mass[:, i, i]))[:, None] * along
    arguments: dict[str, Any] = {
        "name": "made_up",
        "omega": omega,
        "added_mass": mass,
        "radiation_damping": 0.3 * damping[:, None, None] * size,
        "added_mass_inf": size,
        "headings": headings,
        "excitation": force,
        "hydrostatic_stiffness": stiffness,
        "volume": volume,
        "centre_of_buoyancy": [0.0, 0.0, -10.0],
        "reference_point": [0.0, 0.0, 0.0],
        "depth": 200.0,
        "density": rho,
        "gravity": g,
        "source": {"solver": "closed forms", "panels": 12},
    }
    return HydroDatabase(**(arguments | changes))


# --- the class ----------------------------------------------------------------------------------


def test_arrays_are_read_only_copies() -> None:
    omega = 0.05 * np.arange(1, 61)
    db = consistent(omega=omega)
    omega[0] = 7.0
    assert db.omega[0] == 0.05
    for array in (db.omega, db.added_mass, db.excitation, db.reference_point):
        assert array.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
    with pytest.raises(TypeError):
        db.source["solver"] = "other"  # type: ignore[index]


def test_all_shape_problems_at_once() -> None:
    with pytest.raises(ModelError) as caught:
        consistent(
            added_mass_inf=np.eye(3), reference_point=[0.0], depth=-200.0, headings=np.radians([10.0, 0.0])
        )
    text = str(caught.value)
    assert len(caught.value.problems) == 5  # the excitation does not fit two headings either
    for part in (
        "'made_up'",
        "added_mass_inf has shape (3, 3), must be (6, 6)",
        "reference_point",
        "depth is -200",
    ):
        assert part in text


@pytest.mark.parametrize("omega", [[0.0, 0.1], [0.2, 0.1], [0.1, np.inf], [0.1, np.nan]])
def test_frequencies_must_be_finite_positive_and_increasing(omega: list[float]) -> None:
    with pytest.raises(ModelError, match="finite positive frequencies"):
        replace(consistent(omega=np.array([0.5, 0.6])), omega=np.array(omega))


# --- Kramers-Kronig -----------------------------------------------------------------------------


def test_added_mass_from_damping_closed_form_second_order() -> None:
    errors = []
    for step in (0.04, 0.02):
        omega = np.array([step * k for k in range(1, round(20.0 / step) + 1)])
        exact, damping = lorentzian(omega)
        low = omega <= 10.0
        errors.append(np.abs(added_mass_from_damping(omega, damping) - exact)[low].max())
    assert errors[1] < 4e-3 * 1.9  # of the largest value, A(0) - A_inf = 1 / (a^2 + b^2)
    assert errors[0] / errors[1] > 3.5


# --- checks -------------------------------------------------------------------------------------


def severities(db: HydroDatabase) -> dict[str, str]:
    return {finding.quantity: finding.severity for finding in check_database(db)}


def test_consistent_database_passes_everything() -> None:
    found = severities(consistent())
    assert found.pop("radiated energy") != "ok"  # waves of these kernels are unknown: see test_hydro_check.py
    assert len(found) == 13
    assert set(found.values()) == {"ok"}, found


def test_buoyancy_beside_the_reference_point_is_no_defect() -> None:
    """C46 = -rho g V x_B and C56 = -rho g V y_B (WAMIT manual v7, section 3.1, without the weight) stand alone."""
    db = consistent()
    stiffness = db.hydrostatic_stiffness.copy()
    stiffness[3, 5], stiffness[4, 5] = -db.density * db.gravity * db.volume * np.array([30.0, -10.0])
    found = severities(consistent(hydrostatic_stiffness=stiffness))
    assert found["symmetry of hydrostatic stiffness"] == "ok"


def spoiled(name: str, index: tuple[Any, ...], factor: complex, add: float = 0.0) -> HydroDatabase:
    db = consistent()
    array = getattr(db, name).copy()
    array[index] = array[index] * factor + add
    return replace(db, **{name: array})


@pytest.mark.parametrize(
    ("make", "quantity", "severity"),
    [
        (lambda: spoiled("added_mass", (3, 0, 4), np.nan), "finite numbers", "error"),
        (lambda: spoiled("excitation", (3, 0, 4), np.nan, np.nan), "finite numbers", "error"),
        (lambda: spoiled("added_mass", (slice(None), 0, 4), -1.0), "symmetry of added mass", "error"),
        (lambda: spoiled("radiation_damping", (15, 0, 4), -1.0), "symmetry of radiation damping", "error"),
        (
            lambda: spoiled("added_mass_inf", (0, 4), -1.0),
            "symmetry of added mass at infinite frequency",
            "error",
        ),
        (
            lambda: spoiled("hydrostatic_stiffness", (2, 4), 1.0, 4e7),
            "symmetry of hydrostatic stiffness",
            "error",
        ),
        (lambda: spoiled("radiation_damping", (15, 2, 2), -1.0), "positive damping", "error"),
        (lambda: spoiled("radiation_damping", (0, 2, 2), 1.0, -3e5), "positive damping", "warning"),
        (lambda: spoiled("added_mass_inf", (2, 2), 1.05), "added mass at infinite frequency", "warning"),
        (lambda: spoiled("added_mass_inf", (2, 2), 1.3), "added mass at infinite frequency", "error"),
        (
            lambda: spoiled("excitation", (slice(None), slice(None), 2), 1 / 9.81),
            "long-wave heave excitation",
            "error",
        ),
        (
            lambda: spoiled("excitation", (slice(None), slice(None), 2), 1j),
            "long-wave heave excitation",
            "error",
        ),
        (lambda: consistent(omega=0.05 * np.arange(1, 25)), "highest frequency", "warning"),
        (lambda: consistent(omega=0.05 * np.arange(1, 16)), "highest frequency", "error"),
        (lambda: consistent(omega=0.1 * np.arange(1, 31)), "frequency step", "warning"),
        (lambda: consistent(omega=0.4 * np.arange(1, 11)), "frequency step", "error"),
        (lambda: consistent(omega=0.4 * np.arange(1, 11)), "long-wave heave excitation", "warning"),
    ],
)
def test_each_defect_is_found(make: Callable[[], HydroDatabase], quantity: str, severity: str) -> None:
    assert severities(make())[quantity] == severity


def test_missing_headings_are_found() -> None:
    db = consistent()
    thin = replace(db, headings=db.headings[::3], excitation=db.excitation[:, ::3])
    half = replace(db, headings=db.headings[18:], excitation=db.excitation[:, 18:])  # 0 to 170 degrees
    assert severities(thin)["heading step"] == severities(half)["heading step"] == "warning"


# --- the file -----------------------------------------------------------------------------------


def test_round_trip(tmp_path: Path) -> None:
    db = consistent(
        added_mass_zero=2.0 * consistent().added_mass_inf,
        hull_vertices=[[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 1.0, -1.0], [0.0, 1.0, -1.0]],
        hull_faces=[[0, 1, 2, 3]],
        depth=math.inf,
    )
    db.write(tmp_path / "a.nc")
    back = HydroDatabase.read(tmp_path / "a.nc")
    for name in (
        "omega",
        "headings",
        "hydrostatic_stiffness",
        "centre_of_buoyancy",
        "hull_vertices",
        "hull_faces",
    ):
        assert np.array_equal(getattr(back, name), getattr(db, name)), name
    for name in ("added_mass", "radiation_damping", "added_mass_inf", "added_mass_zero", "excitation"):
        np.testing.assert_allclose(getattr(back, name), getattr(db, name), rtol=1e-7, err_msg=name)  # float32
    assert (back.name, back.volume, back.depth, back.density) == (db.name, db.volume, db.depth, db.density)
    assert dict(back.source) == dict(db.source)


def test_file_has_capytaine_names_and_opens_in_xarray(tmp_path: Path) -> None:
    consistent().write(tmp_path / "a.nc")
    with xr.open_dataset(tmp_path / "a.nc") as data:
        assert data.added_mass.dims == ("omega", "influenced_dof", "radiating_dof")
        surge_pitch = data.added_mass.sel(influenced_dof="Surge", radiating_dof="Pitch")
        np.testing.assert_allclose(surge_pitch, consistent().added_mass[:, 0, 4], rtol=1e-7)
        assert data.excitation.sel(complex="im").dims == ("omega", "wave_direction", "influenced_dof")
        assert data.added_mass.dtype == np.float32
        assert data.attrs["time_sign"] == "exp(+i omega t)"


def test_other_time_sign_is_conjugated(tmp_path: Path) -> None:
    """Re(X e^{-i w t}) and Re(conj(X) e^{+i w t}) are the same force."""
    consistent().write(tmp_path / "a.nc")
    with netCDF4.Dataset(tmp_path / "a.nc", "a") as file:
        file.time_sign = "exp(-i omega t)"
    back = HydroDatabase.read(tmp_path / "a.nc")
    np.testing.assert_allclose(back.excitation, np.conj(consistent().excitation), rtol=1e-7)
    assert back.excitation[0, 18, 0].imag < 0.0


def test_dimensions_in_any_order(tmp_path: Path) -> None:
    db = spoiled("added_mass", (slice(None), 0, 4), 3.0)  # not symmetric, so that the order matters
    db.write(tmp_path / "a.nc")
    data = xr.load_dataset(tmp_path / "a.nc")
    data.transpose("radiating_dof", "influenced_dof", "wave_direction", ...).to_netcdf(tmp_path / "b.nc")
    back = HydroDatabase.read(tmp_path / "b.nc")
    np.testing.assert_allclose(back.added_mass, db.added_mass, rtol=1e-7)
    np.testing.assert_allclose(back.excitation, db.excitation, rtol=1e-7)


def edited(path: Path, change: Callable[[xr.Dataset], xr.Dataset]) -> Path:
    consistent().write(path)
    change(xr.load_dataset(path)).to_netcdf(path)
    return path


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: data.drop_vars("added_mass_inf"), "variable 'added_mass_inf' is missing"),
        (
            lambda data: data.assign_attrs(phase_origin="body"),
            "phase_origin is 'body', must be 'world origin'",
        ),
        (
            lambda data: data.assign_attrs(time_sign="?"),
            r"time_sign is '\?', must be 'exp\(\+i omega t\)' or",
        ),
        (
            lambda data: xr.concat([data, data], "body", data_vars="minimal"),
            r"must be \(60, 12, 12\) \(60 frequencies, 36 headings, 2 bodies\)",
        ),
    ],
)
def test_unusable_files_are_refused(
    tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset], message: str
) -> None:
    with pytest.raises(ModelError, match=message):
        HydroDatabase.read(edited(tmp_path / "a.nc", change))


def test_paths_that_cannot_be_used(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"nothing\.nc': cannot be read"):
        HydroDatabase.read(tmp_path / "nothing.nc")
    (tmp_path / "text.nc").write_text("not netCDF")
    with pytest.raises(ModelError, match=r"text\.nc': cannot be read"):
        HydroDatabase.read(tmp_path / "text.nc")
    with pytest.raises(ModelError, match="cannot be written"):
        consistent().write(tmp_path / "no" / "folder.nc")


# --- does it belong to the model? ---------------------------------------------------------------


def test_require_match() -> None:
    good: dict[str, Any] = {
        "depth": 200.0,
        "reference_point": (0.0, 0.0, 0.0),
        "density": 1000.0,
        "gravity": 9.81,
    }
    require_match(consistent(), **good)
    require_match(consistent(), **(good | {"depth": 201.0, "gravity": 9.80665}))
    require_match(consistent(depth=math.inf), **(good | {"depth": math.inf}))
    with pytest.raises(ModelError) as caught:
        require_match(
            consistent(), depth=320.0, reference_point=(0.0, 0.0, -14.4), density=1025.0, gravity=10.0
        )
    assert len(caught.value.problems) == 4
    assert "water depth is 200 m, the model has 320 m" in str(caught.value)
    assert "(0, 0, 0) m, the body's is (0, 0, -14.4) m" in str(caught.value)
    # deep water will do where the waves that the body makes do not feel the bed, tanh(k h) > 0.99 at the peak of B
    deep = consistent(depth=math.inf)
    damping = deep.radiation_damping[:, 2, 2]
    k = deep.omega[damping.argmax()] ** 2 / 9.81
    require_match(deep, **(good | {"depth": 1.05 * math.atanh(0.99) / k}))
    with pytest.raises(ModelError, match="depth is inf m"):
        require_match(deep, **(good | {"depth": 0.95 * math.atanh(0.99) / k}))


# --- VolturnUS-S --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def shipped() -> HydroDatabase:
    return HydroDatabase.read(SHIPPED)


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("volturnus_s_bem", MODELS / "volturnus_s_bem.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_shipped_database_is_small_and_consistent(shipped: HydroDatabase) -> None:
    assert SHIPPED.stat().st_size < 500_000
    assert {finding.severity for finding in check_database(shipped)} == {"ok"}
    require_match(shipped, depth=200.0, reference_point=(0.0, 0.0, 0.0), density=1025.0, gravity=9.81)


def test_shipped_database_has_the_published_hydrostatics(shipped: HydroDatabase) -> None:
    """Allen et al. (2020), NREL/TP-5000-76773: 20206 m3, centre of buoyancy 13.63 m below the surface."""
    assert shipped.volume == pytest.approx(20206.35, abs=0.01)  # PtfmVol0 of the OpenFAST model
    assert shipped.centre_of_buoyancy[0, 2] == pytest.approx(-13.63, abs=0.005)
    waterplane = math.pi * (5.0**2 + 3 * 6.25**2)
    assert shipped.hydrostatic_stiffness[2, 2] == pytest.approx(1025.0 * 9.81 * waterplane, rel=1e-12)
    # three outer columns at 51.75 m: I = 3/2 A R^2 + sum pi r^4 / 4
    moment = 1.5 * math.pi * 6.25**2 * 51.75**2 + 0.25 * math.pi * (5.0**4 + 3 * 6.25**4)
    tilt = 1025.0 * 9.81 * (moment + 20206.35 * -13.6261)
    assert np.diag(shipped.hydrostatic_stiffness)[3:] == pytest.approx([tilt, tilt, 0.0], rel=1e-5)


def test_shipped_mesh_is_the_one_the_script_makes(shipped: HydroDatabase, script: ModuleType) -> None:
    assert shipped.hull_vertices is not None and shipped.hull_faces is not None
    mesh = (shipped.hull_vertices, shipped.hull_faces)
    script.check_mesh(mesh)
    assert mesh_hash(mesh) == shipped.source["mesh_hash"]
    sector, _ = script.sector_mesh(shipped.source["panel_size"])
    vertices, faces = script.six_images(sector)
    np.testing.assert_allclose(
        np.sort(vertices[faces].mean(axis=1), axis=0),
        np.sort(shipped.hull_vertices[shipped.hull_faces].mean(axis=1), axis=0),
        atol=1e-6,
    )


@pytest.mark.parametrize("size", [4.0, 2.6, 1.1])
def test_meshes_of_other_sizes_are_exact_and_watertight(script: ModuleType, size: float) -> None:
    sector, _ = script.sector_mesh(size)
    script.check_mesh(script.six_images(sector))


def test_a_hole_in_the_mesh_is_found(script: ModuleType) -> None:
    sector, _ = script.sector_mesh(2.6)
    vertices, faces = script.six_images(sector)
    flat = np.ptp(vertices[faces][:, :, 0], axis=1) + np.ptp(vertices[faces][:, :, 1], axis=1)
    wall = int(np.argmin(np.where(vertices[faces][:, :, 2].mean(axis=1) < -14.0, np.abs(flat - 2.0), np.inf)))
    with pytest.raises(AssertionError):
        script.check_mesh((vertices, np.delete(faces, wall, axis=0)))


def test_shipped_d3_symmetry(shipped: HydroDatabase) -> None:
    """Turning by 120 degrees and mirroring at y = 0 leave A and B as they are; X turns with the wave."""
    cos, sin = math.cos(2.0 * math.pi / 3.0), math.sin(2.0 * math.pi / 3.0)
    turn = np.kron(np.eye(2), np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]))
    mirror = np.diag([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    for matrices in (shipped.added_mass, shipped.radiation_damping, shipped.added_mass_inf[None]):
        for image in (turn, mirror):
            np.testing.assert_allclose(
                image @ matrices @ image.T, matrices, atol=1e-6 * np.abs(matrices).max()
            )
    assert np.allclose(np.diff(shipped.headings), math.radians(5.0))
    x = shipped.excitation
    peak = np.abs(x).max(axis=(0, 1))
    assert np.all(np.abs(np.roll(x, -24, axis=1) - x @ turn.T) < 1e-5 * peak)
    assert np.all(np.abs(x[:, (-np.arange(72)) % 72] - x @ mirror) < 1e-5 * peak)


def test_shipped_phases(shipped: HydroDatabase) -> None:
    """Long waves: heave follows the crest at the origin; surge leads it by 90 degrees, as du/dt does."""
    ahead = int(np.argmin(np.abs(shipped.headings)))
    assert shipped.headings[ahead] == pytest.approx(0.0, abs=1e-12)
    surge, heave = shipped.excitation[1, ahead, 0], shipped.excitation[1, ahead, 2]
    assert np.degrees(np.angle(heave)) == pytest.approx(0.0, abs=0.5)
    assert np.degrees(np.angle(surge)) == pytest.approx(90.0, abs=1.0)
    back = shipped.excitation[1, 0, 0]  # heading -180 degrees
    assert np.degrees(np.angle(back)) == pytest.approx(-90.0, abs=1.0)


def test_shipped_damping_equals_radiated_energy(shipped: HydroDatabase) -> None:
    """B_ii = k / (8 pi rho g c_g) int |X_i|^2 d(heading): Newman, Marine Hydrodynamics (1977)."""
    h, g, rho = shipped.depth, shipped.gravity, shipped.density
    for index in (7, 11, 15, 19, 27):  # 0.4 to 1.4 rad/s
        w = shipped.omega[index]
        k = w * w / g
        for _ in range(200):
            k = w * w / (g * math.tanh(k * h))
        group = 0.5 * w / k * (1.0 + 2.0 * k * h / math.sinh(2.0 * k * h))
        energy = np.sum(np.abs(shipped.excitation[index]) ** 2, axis=0) * math.radians(5.0)
        radiated = k / (8.0 * math.pi * rho * g * group) * energy
        got = np.diag(shipped.radiation_damping[index])
        peak = np.abs(np.diagonal(shipped.radiation_damping, axis1=1, axis2=2)).max(axis=0)
        assert np.all(np.abs(got - radiated) < 0.01 * radiated + 5e-4 * peak), w


def test_shipped_against_wamit(shipped: HydroDatabase) -> None:
    """WAMIT's coefficients of the same hull: IEA-15-240-RWT, OpenFAST/IEA-15-240-RWT-UMaineSemi/HydroData.

    Its own mesh has 0.3 % less volume and 0.8 % less waterplane.
    """
    infinite = [9.64242e6, 9.64246e6, 2.48217e7, 1.16405e10, 1.16399e10, 2.01375e10]
    assert np.diag(shipped.added_mass_inf) == pytest.approx(infinite, rel=0.01)
    assert shipped.added_mass_inf[0, 4] == pytest.approx(-1.01005e8, rel=0.01)
    assert shipped.added_mass_inf[1, 3] == pytest.approx(1.01004e8, rel=0.01)
    at_06 = [1.31189e7, 1.31190e7, 2.76911e7, 1.36328e10, 1.36321e10, 3.02220e10]
    assert np.diag(shipped.added_mass[11]) == pytest.approx(at_06, rel=0.015)
    damping = [1.215e6, 1.215e6, 3.177e6, 6.306e8, 6.306e8, 4.780e8]
    assert np.diag(shipped.radiation_damping[11]) == pytest.approx(damping, rel=0.02)


def two_bodies() -> HydroDatabase:
    """The consistent body twice, 100 m apart and without influence on each other."""
    one = consistent()
    twice = np.eye(2)
    alone = np.diag(1.0 / (1.0 + np.diagonal(one.added_mass[0])[:2] / (one.density * one.volume[0])))
    incident = one.excitation.copy()  # without the added mass
    incident[:, :, :2] @= alone
    lag = 50.0 * wave_number(one.omega, one.depth, one.gravity)[:, None] * np.sin(one.headings)
    places = np.repeat(np.exp(1j * np.stack([lag, -lag], axis=2)), 6, axis=2)  # 50 m to either side
    return replace(
        one, name="pair", bodies=("left", "right"),
        added_mass=np.kron(twice, one.added_mass), radiation_damping=np.kron(twice, one.radiation_damping),
        added_mass_inf=np.kron(twice, one.added_mass_inf), added_mass_zero=None,
        excitation=np.tile(one.excitation, (1, 1, 2)) * places,
        froude_krylov=np.tile(incident, (1, 1, 2)) * places,
        mean_drift=np.tile(one.excitation.real, (1, 1, 2)),
        hydrostatic_stiffness=np.kron(twice, one.hydrostatic_stiffness), volume=np.tile(one.volume, 2),
        centre_of_buoyancy=one.centre_of_buoyancy + [[0.0, -50.0, 0.0], [0.0, 50.0, 0.0]],
        reference_point=[[0.0, -50.0, 0.0], [0.0, 50.0, 0.0]],
    )  # fmt: skip


def test_two_bodies(tmp_path: Path) -> None:
    db = two_bodies()
    db.write(tmp_path / "pair.nc")
    back = HydroDatabase.read(tmp_path / "pair.nc")
    assert (back.name, back.bodies) == ("pair", ("left", "right"))
    for name in ("added_mass", "excitation", "froude_krylov", "mean_drift", "reference_point", "volume"):
        np.testing.assert_allclose(getattr(back, name), getattr(db, name), rtol=1e-6, atol=1e-6)
    with xr.open_dataset(tmp_path / "pair.nc") as file:
        assert str(file.radiating_dof.values[8]) == "right__Heave"
    assert {finding.quantity for finding in check_database(db) if finding.severity == "error"} == {"radiated energy"}
    assert db.index("right") == db.index(1) == 1
    with pytest.raises(ModelError, match="there is no body 'middle'; it has 'left', 'right'"):
        db.index("middle")
    with pytest.raises(ModelError, match="2 bodies are called 'left'"):
        replace(db, bodies=("left", "left"))


def test_coupling_that_is_not_symmetric_is_found() -> None:
    db = two_bodies()
    A = db.added_mass.copy()
    A[:, 2, 8] += 0.5 * A[:, 2, 2]
    worst = max(check_database(replace(db, added_mass=A)), key=lambda finding: finding.severity == "error")
    assert (worst.severity, worst.quantity) == ("error", "symmetry of added mass")
    assert "left heave-right heave" in worst.message
