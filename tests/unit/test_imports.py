"""What importing floatsim brings along, and which way imports may point."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import floatsim

PACKAGE = Path(floatsim.__file__).parent
CONCRETE = (  # `system` and `solve` know protocols and primitives only
    "floatsim.parts", "floatsim.laws", "floatsim.hydro", "floatsim.sea.spectra", "floatsim.sea.waves",
    "floatsim.joints.ball", "floatsim.joints.weld", "floatsim.joints.clamp", "floatsim.joints.prescribed",
    "floatsim.joints.hinge", "floatsim.joints.slider", "floatsim.joints.universal", "floatsim.joints.cylindrical",
    "floatsim.joints.rod", "floatsim.joints.point_on_line", "floatsim.joints.lock", "floatsim.pto_laws",
)  # fmt: skip


@pytest.mark.parametrize("heavy", ["xarray", "netCDF4", "matplotlib", "rich", "pandas"])
def test_import_is_light(heavy, loaded):
    assert "floatsim" in loaded
    assert heavy not in loaded


@pytest.fixture(scope="module")
def loaded():
    code = "import sys, floatsim; print(*sorted({name.partition('.')[0] for name in sys.modules}))"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()


def imported(path):
    """Dotted names of everything a file imports, inside functions too; of `from a import b` both a and a.b."""
    package = ["floatsim", *path.relative_to(PACKAGE).parts[:-1]]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (item.name for item in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{item.name}" for item in node.names)


def offences(folders, forbidden):
    for folder in folders:
        for path in sorted((PACKAGE / folder).rglob("*.py")):
            for name in imported(path):
                if any(name == item or name.startswith(item + ".") for item in forbidden):
                    yield f"{path.relative_to(PACKAGE)} imports {name}"


def test_system_and_solve_know_nothing_concrete():
    assert not list(offences(["system", "solve"], CONCRETE))


@pytest.mark.parametrize(
    "folders, above",
    [
        (["system"], ["solve", "study", "cli"]),
        (["solve"], ["study", "cli"]),
        (["parts", "joints", "laws", "pto_laws", "sea", "hydro"], ["system", "solve", "study", "cli"]),
        (["study"], ["cli"]),
    ],
)
def test_imports_point_downwards(folders, above):
    assert not list(offences(folders, [f"floatsim.{item}" for item in above]))


def test_the_walk_sees_imports():
    """The tests above can fail: this test's own subject is found where it is known to be."""
    assert "floatsim.parts.line.Line" in set(imported(PACKAGE / "parts" / "end_bending.py"))
    assert list(offences(["study"], ["floatsim.parts"]))
