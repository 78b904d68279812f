"""The page of plots: it is made from a full file, from a static one, and refused clearly."""

import numpy as np
import pytest

import floatsim as fs
from floatsim.errors import CaseError
from floatsim.study.plot import _line_panels, _shapes, _vertical_plane, plot_file
from floatsim.study.store import Channel, Coordinate, Writer

CHANNELS = (
    Channel("box_position", "box: displacement", "mixed", ("dof",), "float", "m m m rad rad rad"),
    Channel("rope_position", "rope: position of the nodes", "m", ("rope_node", "xyz")),
    Channel("rope_tension", "rope: effective tension", "N", ("rope_element",)),
    Channel("wave_elevation", "wave elevation", "m"),
    Channel("newton_iterations", "Newton iterations", "1", (), "int32"),
)
COORDINATES = (
    Coordinate("dof", "degree of freedom", "1", "dof", ("surge", "sway", "heave", "roll", "pitch", "yaw")),
    Coordinate("xyz", "world axis", "1", "xyz", ("x", "y", "z")),
    Coordinate("rope_arc_length", "arc length", "m", "rope_node", np.arange(3.0)),
    Coordinate("rope_element_arc_length", "arc length", "m", "rope_element", np.arange(2.0) + 0.5),
)


@pytest.mark.parametrize("samples", [1, 50])
def test_page(tmp_path, samples):
    with Writer(tmp_path / "out.nc", CHANNELS, COORDINATES, {"water_depth": 200.0}) as writer:
        for k in range(samples):
            writer.append(0.1 * k, np.sin(0.1 * k + np.arange(writer.width)))
    plot_file(tmp_path / "out.nc", tmp_path / "out.png")
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "out.png").stat().st_size > 20_000


def test_refusals(tmp_path):
    with pytest.raises(CaseError, match=r"no result file '.*out.nc'"):
        plot_file(tmp_path / "out.nc", tmp_path / "out.png")
    (tmp_path / "text.nc").write_text("not a netCDF file")
    with pytest.raises(CaseError, match="not a netCDF file"):
        plot_file(tmp_path / "text.nc", tmp_path / "out.png")
    with Writer(tmp_path / "out.nc", CHANNELS, COORDINATES):
        pass
    with pytest.raises(CaseError, match="holds no samples"):
        plot_file(tmp_path / "out.nc", tmp_path / "out.png")
    with Writer(tmp_path / "out.nc", CHANNELS, COORDINATES) as writer:
        writer.append(0.0, np.zeros(writer.width))
    with pytest.raises(CaseError, match=r"picture '.*' cannot be written"):
        plot_file(tmp_path / "out.nc", tmp_path / "missing" / "out.png")
    assert list(tmp_path.glob("*.png")) == []


RISER = fs.Section(name="riser", mass_per_length=20.0, diameter=0.1, EA=1e8, EI=2e4, breaking_load=3e5,
                   minimum_bend_radius=3.0)  # fmt: skip


@pytest.fixture(scope="module")
def riser(tmp_path_factory):
    """A cable over a sloping bed in the plane through (0, 0) and (30, 40), 3 s of a run, and its shapes."""
    line = fs.Line(name="cable", section=RISER, length=75.0, elements=15)
    guy = fs.Line(name="guy", section=RISER, length=75.0, elements=15)
    system = fs.assemble(
        fs.Model(
            name="riser", parts=[line, guy], sea=fs.Sea(depth=60.0, seabed=fs.Seabed(slope=(-0.1, 0.0))),
            joints=[fs.Clamp(a="cable.end_a", b=(0.0, 0.0, -10.0), direction=(0.0, 0.0, -1.0)),
                    fs.Ball(a="cable.end_b", b=(30.0, 40.0, -63.0)),
                    fs.Ball(a="guy.end_a", b=(0.0, 0.0, -10.0)), fs.Ball(a="guy.end_b", b=(-30.0, -40.0, -57.0))],
        )
    )  # fmt: skip
    path = tmp_path_factory.mktemp("plot") / "riser.nc"
    assert fs.simulate(system, 3.0, 0.1, output=path).status == "done"
    return path


def drawn(draw, *arguments):
    from matplotlib.figure import Figure

    ax = Figure().subplots()
    draw(ax, *arguments)
    return ax


def test_side_view_of_one_line_over_its_bed(riser):
    import xarray

    with xarray.open_dataset(riser) as data:
        ax = drawn(_shapes, data, ["cable"])
        shape, _, bed, surface = ax.get_lines()
        assert shape.get_xdata()[[0, -1]] == pytest.approx([0.0, 50.0], abs=1e-6)
        assert shape.get_ydata() == pytest.approx(data["cable_position"].values[-1, :, 2])
        # the bed under a line that goes in the direction (0.6, 0.8)
        assert bed.get_ydata() == pytest.approx(-60.0 - 0.1 * 0.6 * bed.get_xdata(), abs=1e-6)
        assert list(surface.get_ydata()) == [0.0, 0.0]
        # both lines lie in that plane, and none is left out
        ax = drawn(_shapes, data, ["cable", "guy"])
        assert ax.get_xlabel().startswith("distance along 53 deg from x")
        assert ax.get_lines()[0].get_xdata()[-1] == pytest.approx(50.0)
        assert ax.get_lines()[3].get_xdata()[-1] == pytest.approx(-50.0)


def test_band_along_a_line_is_its_range(riser):
    import xarray

    with xarray.open_dataset(riser) as data:
        panel = _line_panels(data, ["cable"], ("tension",))[-1]
        ax = drawn(panel)
        tension = data["cable_tension"].values / 1e3
        assert ax.get_lines()[0].get_ydata() == pytest.approx(tension.mean(axis=0))
        band = ax.collections[0].get_paths()[0].vertices[:, 1]
        assert (band.min(), band.max()) == pytest.approx((tension.min(), tension.max()))
        panels = _line_panels(data, ["cable"], ("tension", "curvature", "curvature_utilisation", "bending_moment"))
        assert len(panels) == 6  # with the largest tension over time and the shape


def test_plane_of_lines():
    loop = np.array([[0.0, 0.0, 0.0], [3.0, 4.0, -5.0], [0.0, 0.0, -9.0]])
    straight = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, -9.0]])
    star = [np.array([[0.0, 0.0, 0.0], [np.cos(a), np.sin(a), -1.0]]) for a in (0.0, 2.1, 4.2)]
    assert _vertical_plane([loop])[1] == pytest.approx([0.6, 0.8])
    assert _vertical_plane([straight])[1] == pytest.approx([1.0, 0.0])
    origin, way, label = _vertical_plane(star)
    assert (list(origin), list(way), label) == ([0.0, 0.0], [1.0, 0.0], "x")
    assert _vertical_plane([loop, -loop])[1] == pytest.approx([0.6, 0.8])


def test_one_line_and_part_of_a_run(riser, tmp_path):
    from typer.testing import CliRunner

    from floatsim.cli import app

    for k, more in enumerate((["--line", "cable"], ["--range", "1", "2"], ["--line", "guy", "--range", "0", "0"])):
        out = tmp_path / f"{k}.png"
        result = CliRunner().invoke(app, ["plot", str(riser), "-o", str(out), *more])
        assert result.exit_code == 0, result.output
        assert out.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(CaseError, match=r"line: got 'cabel'.*did you mean 'cable'"):
        plot_file(riser, tmp_path / "a.png", "cabel")
    with pytest.raises(CaseError, match="no samples from 7 s to 9 s; there are samples from 0 to 3 s"):
        plot_file(riser, tmp_path / "a.png", start=7.0, end=9.0)
    with pytest.raises(CaseError, match="start: got 2 s, after the end at 1 s"):
        plot_file(riser, tmp_path / "a.png", start=2.0, end=1.0)
    assert not (tmp_path / "a.png").exists()


def test_ptos_and_rotors_have_panels(tmp_path):
    """One panel for every quantity and unit: two sliders share one, a hinge's angle has its own, in degrees."""
    from floatsim.study.plot import _told_panels

    channels = (
        Channel("a_force", "force", "N"), Channel("b_force", "force", "N"), Channel("c_displacement", "angle", "rad"),
        Channel("wave_elevation", "wave elevation", "m"), Channel("d_power", "never moved", "W"),
    )  # fmt: skip
    with Writer(tmp_path / "out.nc", channels) as writer:
        for k in range(5):
            writer.append(0.1 * k, [1e3 * k, 2e3 * k, 0.1 * k, 1.0, 0.0])
    import matplotlib.pyplot as plt
    import xarray

    with xarray.open_dataset(tmp_path / "out.nc") as data:
        panels = _told_panels(data)
        figure, axes = plt.subplots(1, 2)
        for ax, draw in zip(axes, panels, strict=True):
            draw(ax)
    assert [ax.get_ylabel() for ax in axes] == ["force [kN]", "c displacement [deg]"]
    assert axes[0].lines[1].get_ydata()[-1] == pytest.approx(8.0)
    assert axes[1].lines[0].get_ydata()[-1] == pytest.approx(np.degrees(0.4))
    plt.close(figure)
