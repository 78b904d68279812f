"""QTF: symmetry, interpolation, what is not known, WAMIT's files and their conventions, bad input."""

import gzip

import numpy as np
import pytest
from second_order import formula, sum_formula, synthetic

from floatsim.errors import ModelError
from floatsim.hydro.qtf import QTF, read_wamit_qtf

OMEGA = np.array([0.4, 0.5, 0.65, 0.8])  # uneven on purpose


def qtf(T, **changes):
    values = {"name": "test", "kind": "difference", "omega": OMEGA, "headings": np.zeros(1), "transfer": T,
              "reference_point": np.zeros(3)}  # fmt: skip
    return QTF(**(values | changes))


def bilinear_in_mean_and_difference(first, second):
    """Linear along mean and difference: what the interpolation must reproduce, kinks only where mu = 0."""
    mean, mu = 0.5 * (first + second), first - second
    return (np.arange(1, 7) * (2.0 + 3.0 * mean)[..., None] + 1j * (5.0 * mu)[..., None]).astype(complex)


def test_one_half_gives_the_other():
    T = formula(OMEGA[:, None], OMEGA)[None]
    for keep in (np.tril, np.triu):
        half = T.copy()
        half[:, ~keep(np.ones((4, 4), dtype=bool))] = np.nan
        np.testing.assert_allclose(qtf(half).transfer, T, rtol=1e-14, atol=1e-14)
    S = sum_formula(OMEGA[:, None], OMEGA)[None]
    half = S.copy()
    half[:, ~np.tril(np.ones((4, 4), dtype=bool))] = np.nan
    np.testing.assert_allclose(qtf(half, kind="sum").transfer, S, rtol=1e-14)


def test_fields_linear_in_mean_and_difference_are_exact():
    T = bilinear_in_mean_and_difference(OMEGA[:, None], OMEGA)[None]
    w = np.linspace(0.4, 0.8, 37)
    exact = bilinear_in_mean_and_difference(w[:, None], w)
    np.testing.assert_allclose(qtf(T).matrix(w, 0.0), exact, rtol=1e-12)


def test_interpolated_matrix_is_hermitian_and_its_diagonal_the_mean_drift():
    q = synthetic()
    w = np.sort(np.random.default_rng(3).uniform(0.2, 2.5, 60))
    T = q.matrix(w, 0.0)
    np.testing.assert_allclose(T, T.swapaxes(0, 1).conj(), rtol=0, atol=1e-9)
    diagonal = np.einsum("mmd->md", T)
    assert np.abs(diagonal.imag).max() == 0.0
    known = np.einsum("mmd->md", q.transfer[0]).real
    for d in range(6):
        np.testing.assert_allclose(diagonal[:, d].real, np.interp(w, q.omega, known[:, d]), rtol=1e-12, atol=1e-9)
    S = synthetic("sum").matrix(w, 0.0)
    np.testing.assert_allclose(S, S.swapaxes(0, 1), rtol=1e-14)


def test_interpolation_is_of_second_order():
    w = np.linspace(0.25, 2.4, 113)
    exact = formula(w[:, None], w)
    scale = np.abs(exact).max(axis=(0, 1))[[0, 2, 4]]
    error = [
        (np.abs(synthetic(step=step).matrix(w, 0.0) - exact).max(axis=(0, 1))[[0, 2, 4]] / scale).max()
        for step in (0.1, 0.05, 0.025)
    ]
    assert error[0] < 0.02
    assert error[0] / error[1] > 3.0 and error[1] / error[2] > 3.0


def test_outside_the_range_and_beside_what_was_never_computed():
    T = formula(OMEGA[:, None], OMEGA)[None]
    T[:, 3, 0] = T[:, 0, 3] = np.nan  # the largest difference of frequencies was left out
    out = qtf(T).matrix(np.array([0.39, 0.4, 0.45, 0.75, 0.8, 0.81]), 0.0)[..., 0]
    unknown = np.isnan(out)
    assert unknown[0].all() and unknown[:, 5].all()
    assert unknown[1, 4] and unknown[4, 1] and unknown[2, 3] and unknown[3, 2]
    assert not unknown[1:3, 1:3].any() and not unknown[3:5, 3:5].any()


def test_headings_between_two_and_near_one():
    T = formula(OMEGA[:, None], OMEGA)
    q = qtf(np.stack([T, 3.0 * T]), headings=np.radians([-10.0, 10.0]))
    np.testing.assert_allclose(q.matrix(OMEGA, np.radians(5.0)), 2.5 * T, rtol=1e-12)
    np.testing.assert_allclose(q.matrix(OMEGA, np.radians(370.0)), 3.0 * T, rtol=1e-12)
    np.testing.assert_allclose(q.matrix(OMEGA, np.radians(10.9)), 3.0 * T, rtol=1e-12)
    with pytest.raises(ModelError, match=r"'test': waves at 11.1 deg .* known at -10, 10 deg"):
        q.matrix(OMEGA, np.radians(11.1))
    far = qtf(np.stack([T, T]), headings=np.radians([0.0, 90.0]))
    with pytest.raises(ModelError, match="waves at 45 deg"):
        far.matrix(OMEGA, np.radians(45.0))
    across = qtf(np.stack([T, 3.0 * T]), headings=np.radians([-170.0, 170.0]))
    np.testing.assert_allclose(across.matrix(OMEGA, np.pi), 2.0 * T, rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "both"}, "kind is 'both'"),
        ({"omega": OMEGA[::-1]}, "omega must be"),
        ({"omega": np.array([0.0, 0.5, 0.65, 0.8])}, "omega must be"),
        ({"omega": OMEGA[:3]}, r"transfer has shape \(1, 4, 4, 6\), must be \(1, 3, 3, 6\)"),
        ({"headings": np.array([0.0, 7.0])}, "headings must be"),
        ({"reference_point": np.array([0.0, np.nan, 0.0])}, "reference_point"),
        ({"kind": "sum"}, r"entry .* rad/s of degree of freedom \d is not equal to .* other kind"),
    ],
)
def test_bad_tables(changes, message):
    with pytest.raises(ModelError, match="QTF 'test'.*" + message):
        qtf(formula(OMEGA[:, None], OMEGA)[None], **changes)


# --- WAMIT ----------------------------------------------------------------------------------------


def write(path, rows, header=""):
    lines = [header] if header else []
    for t1, t2, b1, b2, i, value in rows:
        mod, phase = abs(value), np.degrees(np.angle(value))
        lines.append(f"{t1:.7e} {t2:.7e} {b1:.5e} {b2:.5e} {i} {mod:.6E} {phase:.6E} {value.real:.6E} {value.imag:.6E}")
    text = "\n".join(lines) + "\n"
    with gzip.open(path, "wt") if path.suffix == ".gz" else path.open("w") as file:
        file.write(text)
    return path


def rows(transfer=formula, dofs=(1, 3, 5), beta=(0.0,), shift=0):
    """The half w1 >= w2 as WAMIT writes it."""
    T = transfer(OMEGA[:, None], OMEGA) / 1e4
    out = []
    for b in beta:
        for n, second in enumerate(OMEGA):
            for m in range(n, 4):
                for i in dofs:
                    out.append((2 * np.pi / OMEGA[m], 2 * np.pi / second, b, b, i + shift, T[m, n, i - 1]))
    return out


@pytest.mark.parametrize("ending", [".12d", ".12d.gz"])
def test_wamit_difference(tmp_path, ending):
    """Units of force: rho g L; of moment: rho g L^2. The first period belongs to the frequency that counts positive."""
    path = write(tmp_path / f"hull{ending}", rows(), header=" T1 T2 B1 B2 I MOD PHASE RE IM")
    q = read_wamit_qtf(path, density=1000.0, gravity=10.0, length=2.0, reference_point=(0.0, 0.0, -3.0))
    assert q.file == path and q.kind == "difference" and q.headings == pytest.approx([0.0])
    assert q.reference_point[2] == -3.0
    np.testing.assert_allclose(q.omega, OMEGA, rtol=1e-6)
    exact = formula(OMEGA[:, None], OMEGA) * np.array([2.0, 2.0, 2.0, 4.0, 4.0, 4.0])
    np.testing.assert_allclose(q.transfer[0], exact, rtol=1e-5, atol=1e-2)


def test_wamit_sum_of_the_second_body_and_two_headings(tmp_path):
    mixed = [(12.0, 12.0, 0.0, 30.0, 7, 1.0 + 0.0j)]  # waves of different headings: not used
    path = write(tmp_path / "two.12s", rows(sum_formula, beta=(0.0, 350.0), shift=6) + rows(formula) + mixed)
    q = read_wamit_qtf(path, density=1000.0, gravity=10.0, body=1)
    np.testing.assert_allclose(np.degrees(q.headings), [-10.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(q.transfer[1], sum_formula(OMEGA[:, None], OMEGA), rtol=1e-5, atol=1e-2)


def test_wamit_files_that_cannot_be_used(tmp_path):
    water = {"density": 1000.0, "gravity": 10.0}
    with pytest.raises(ModelError, match="does not exist"):
        read_wamit_qtf(tmp_path / "none.12d", **water)
    with pytest.raises(ModelError, match=r"ends in \.12d"):
        read_wamit_qtf(write(tmp_path / "hull.3", rows()), **water)
    with pytest.raises(ModelError, match="line 31: this entry was given before"):
        read_wamit_qtf(write(tmp_path / "twice.12d", rows() + rows()[:1]), **water)
    with pytest.raises(ModelError, match="line 2: not numbers"):
        read_wamit_qtf(write(tmp_path / "text.12d", rows(), header="a header\nsome words"), **water)
    with pytest.raises(ModelError, match="line 1: periods -1 and 12 s"):
        read_wamit_qtf(write(tmp_path / "zero.12d", [(-1.0, 12.0, 0.0, 0.0, 1, 1.0 + 0.0j)]), **water)
    with pytest.raises(ModelError, match="no entry of body 2"):
        read_wamit_qtf(write(tmp_path / "one.12d", rows()), body=1, **water)
    both = rows() + [(t2, t1, b, b, i, -value) for t1, t2, b, _, i, value in rows() if t1 != t2]
    with pytest.raises(ModelError, match="not conjugate to"):
        read_wamit_qtf(write(tmp_path / "contradiction.12d", both), **water)
