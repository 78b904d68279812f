"""The page of plots: it is made from a full file, from a static one, and refused clearly."""

import numpy as np
import pytest

from floatsim.errors import CaseError
from floatsim.study.plot import plot_file
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
