"""The command line: exit status 0, 1 or 2, one message a problem, no traceback, no half-made file."""

import os
import re
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from hypothesis import example, given
from hypothesis import strategies as st

import floatsim as fs
from floatsim.cli import main
from floatsim.study.script import input_hash, load_model, parse_parameters

MODELS = Path(__file__).parents[2] / "models"
PENDULUM, CHAIN, VOLTURNUS = (str(MODELS / f"{name}.py") for name in ("pendulum", "hanging_chain", "volturnus_s"))


@pytest.fixture
def floatsim(capsys, monkeypatch, tmp_path):
    """Calls the program in an empty folder: (exit status, standard output, standard error)."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["floatsim", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        assert "Traceback" not in said.err and not re.search(r"(?<!no )\bnan\b", said.out, re.IGNORECASE)
        return left.value.code or 0, said.out, said.err

    return call


def refused(result, *words):
    status, _, said = result
    assert status == 2, said
    assert all(line.startswith(("error: ", "warning: ")) for line in said.splitlines()), said
    for word in words:
        assert word in said, said


# -- help -------------------------------------------------------------------------------------


def test_version(floatsim):
    assert floatsim("--version") == (0, f"floatsim {fs.__version__}\n", "")


def test_help(floatsim):
    status, said, _ = floatsim("--help")
    assert status == 0
    for verb in ("check", "static", "modes", "decay", "run", "plot"):
        assert verb in said
        status, said_of_verb, _ = floatsim(verb, "--help")
        assert status == 0 and len(said_of_verb) > 200


def test_decay_help_repeats_the_units_of_the_offset(floatsim):
    _, said, _ = floatsim("decay", "--help")
    words = " ".join(said.replace("│", " ").split())
    assert "metres for surge, sway, heave and in degrees for roll, pitch, yaw" in words
    assert "METRES for surge, sway, heave; DEGREES for roll, pitch, yaw" in words


def test_no_command(floatsim):
    status, said, error = floatsim()
    assert status == 2 and "Usage" in said + error


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["chek"], ["No such command 'chek'"]),
        (["check"], ["MODEL.py"]),
        (["run", PENDULUM], ["--duration"]),
        (["run", PENDULUM, "--duration", "abc"], ["--duration", "number"]),
        (["run", PENDULUM, "--duration", "1,5"], ["--duration", "number"]),
        (["run", PENDULUM, "--duration", "1", "--setp", "3"], ["--setp"]),
        (["run", PENDULUM, "--duration", "0"], ["duration: got 0.0", "positive number of seconds"]),
        (["run", PENDULUM, "--duration", "-1"], ["duration: got -1.0", "positive number of seconds"]),
        (["run", PENDULUM, "--duration", "nan"], ["duration: got nan", "positive number of seconds"]),
        (["run", PENDULUM, "--duration", "1", "--dt", "0"], ["dt: got 0.0", "positive number of seconds"]),
        (["run", PENDULUM, "--duration", "1", "--dt", "1e-20"], ["more than 1e+12 steps"]),
        (["run", PENDULUM, "--duration", "1", "--interval", "-1"], ["interval: got -1.0"]),
        (["run", PENDULUM, "--duration", "1", "--channel", "rod_positon"], ["'rod_positon'", "'rod_position'"]),
        (["run", PENDULUM, "--duration", "1", "--precision", "f4"], ["precision: got 'f4'", "'float32'"]),
        (["run", PENDULUM, "--duration", "1e12", "--dt", "10"], ["out.nc", "would take", "there is room for"]),
        (["run", PENDULUM, "--duration", "1", "-o", "nowhere/x.nc"], ["'nowhere/x.nc'", "no folder 'nowhere'"]),
        (["run", PENDULUM, "--duration", "1", "-o", "."], ["'.' is a folder"]),
        (["run", PENDULUM, "--duration", "1", "-o", ""], ["output file: got ''"]),
        (["static", PENDULUM, "-o", "nowhere/x.nc"], ["'nowhere/x.nc'", "no folder 'nowhere'"]),
        (["decay", PENDULUM, "--dof", "pitch", "--offset", "1", "-o", "nowhere/x.nc"], ["no folder 'nowhere'"]),
        (["decay", PENDULUM, "--dof", "pich", "--offset", "1"], ["'pich'", "did you mean 'pitch'"]),
        (["decay", PENDULUM, "--dof", "pitch", "--offset", "nan"], ["offset: got nan", "(rotations) degrees"]),
        (["decay", PENDULUM, "--dof", "pitch", "--offset", "1", "--release", "abs"], ["'abs'", "'absolute'"]),
        (["decay", PENDULUM, "--dof", "pitch", "--offset", "1", "--body", "rodd"], ["'rodd'", "'rod'"]),
        (["decay", PENDULUM, "--dof", "surge", "--offset", "1"], ["'rod'", "joint 'hinge' would be open by 1 m"]),
        (["decay", CHAIN, "--dof", "surge", "--offset", "1"], ["'hanging_chain' has no body"]),
        (["modes", PENDULUM, "--count", "0"], ["count", "positive"]),
        (["plot", "nothing.nc"], ["'nothing.nc'"]),
        (["plot", PENDULUM], [PENDULUM, "not a netCDF file"]),
    ],
)
def test_requests(floatsim, tmp_path, arguments, words):
    refused(floatsim(*arguments), *words)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="the superuser may write anywhere")
def test_no_permission(floatsim, tmp_path):
    (tmp_path / "locked").mkdir(mode=0o555)
    refused(floatsim("run", PENDULUM, "--duration", "1", "-o", "locked/x.nc"), "'locked/x.nc'", "no permission")


# -- parameters -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "script, parameters, words",
    [
        (PENDULUM, ["lenght=3"], ["build() takes no 'lenght'", "did you mean 'length'"]),
        (PENDULUM, ["length"], ["-p length", "write name=value"]),
        (PENDULUM, ["=3"], ["-p =3", "write name=value"]),
        (PENDULUM, ["two words=3"], ["-p two words=3", "write name=value"]),
        (PENDULUM, ["length=3", "length=4"], ["-p length is given twice"]),
        (PENDULUM, ["mass=-1"], ["Body 'rod': mass: got -1", "positive number"]),
        (PENDULUM, ["mass=True"], ["Body 'rod': mass: got True", "positive number"]),
        (PENDULUM, ["mass=1e999"], ["Body 'rod': mass: got inf", "positive number"]),
        (PENDULUM, ["length=abc"], ["pendulum.py', line ", "with length='abc'", "TypeError"]),
        (PENDULUM, ["length=2,5"], ["pendulum.py', line ", "with length=(2, 5)", "TypeError"]),
        (CHAIN, ["elements=2.5"], ["Line 'chain': elements: got 2.5", "positive whole number"]),
        (CHAIN, ["span=120"], ["Line 'chain'", "20 m too short"]),
        (VOLTURNUS, ["depth=100"], ["Body 'platform'", "water depth is 200 m", "the model has 100 m"]),
        (VOLTURNUS, ["hydro=nothing.nc"], ["'nothing.nc'", "No such file"]),
        (VOLTURNUS, ["hydro=3"], ["database: got 3", "path of a file"]),
    ],
)
def test_parameters(floatsim, script, parameters, words):
    options = [text for pair in parameters for text in ("-p", pair)]
    refused(floatsim("check", script, *options), *words)


@pytest.mark.parametrize("content", [b"", b"garbage", None, "folder"])
def test_database_that_cannot_be_read(floatsim, tmp_path, content):
    broken = tmp_path / "hull.nc"
    if content == "folder":
        broken.mkdir()
    else:
        whole = (MODELS / "volturnus_s_hydro.nc").read_bytes()
        broken.write_bytes(whole[: len(whole) // 2] if content is None else content)
    refused(floatsim("check", VOLTURNUS, "-p", f"hydro={broken}"), str(broken), "cannot be read")


def test_database_that_lacks_something(floatsim, tmp_path):
    with netCDF4.Dataset(tmp_path / "hull.nc", "w") as file:
        file.createDimension("omega", 3)
        file.createVariable("omega", "f8", ("omega",))[:] = [1.0, 2.0, 3.0]
    refused(
        floatsim("check", VOLTURNUS, "-p", "hydro=hull.nc"), "'hull.nc'", "'added_mass' is missing", "'rho' is missing"
    )


def test_parameter_values():
    given_as = ["a=1", "b=2.5", "c=true", "d=None", "e=hull.nc", "f=(1, 2)", "g=C:\\data", "h=", "i='x=y'", "j=nan"]
    expected = [1, 2.5, True, None, "hull.nc", (1, 2), "C:\\data", "", "x=y", "nan"]
    values = parse_parameters(given_as)
    assert list(values.values()) == expected
    assert [type(y) for y in values.values()] == [type(y) for y in expected]


@given(st.one_of(st.integers(), st.floats(allow_nan=False, allow_infinity=False), st.booleans(), st.none()))
def test_python_values_survive(value):
    got = parse_parameters([f"x={value!r}"])["x"]
    assert got == value and type(got) is type(value)


@given(st.text())
@example("x=" + "(" * 500)
@example("x={[]: 1}")
@example("x=\0")
@example("x=" + "9" * 5000)
def test_any_text_is_a_parameter_or_refused(text):
    try:
        values = parse_parameters([text])
    except fs.CaseError as error:
        assert f"-p {text}: write name=value" in str(error)
        assert "=" not in text or not text.partition("=")[0].isidentifier()
    else:
        assert list(values) == [text.partition("=")[0]]


# -- model scripts ----------------------------------------------------------------------------

SCRIPTS = {
    "raises": ("def build():\n    return 1 / 0\n", "line 2", "ZeroDivisionError: division by zero"),
    "syntax": ("def build(: pass\n", "line 1", "SyntaxError"),
    "import": ("import no_such_module\n", "line 1", "No module named 'no_such_module'"),
    "leaves": ("import sys\nsys.exit(3)\n", "line 2", "SystemExit: 3"),
    "asserts": ("def build():\n    assert False\n", "line 2", "AssertionError"),
    "recursion": ("def build():\n    return build()\n", "line 2", "RecursionError"),
    "many lines": ("def build():\n    raise ValueError('one\\ntwo')\n", "line 2", "ValueError: one two"),
    "not text": ("\0\1", "SyntaxError"),
    "no build": ("x = 1\n", "has no function build"),
    "build is a number": ("build = 3\n", "has no function build"),
    "gives a dictionary": ("def build():\n    return {}\n", "build() returned dict", "floatsim.Model"),
    "gives nothing": ("def build():\n    pass\n", "build() returned NoneType", "floatsim.Model"),
    "built in": ("build = dict\n", "build() returned dict"),
    "needs": ("def build(depth, *, hs):\n    pass\n", "build() needs -p depth=... -p hs=..."),
    "bad model": (
        "import floatsim as fs\ndef build():\n    fs.Section(name='c', mass_per_length=1, diameter=-2, EA=0)\n",
        "Section 'c': diameter: got -2",
        "Section 'c': EA: got 0",
    ),
}


@pytest.mark.parametrize("case", SCRIPTS)
def test_scripts(floatsim, tmp_path, case):
    text, *words = SCRIPTS[case]
    (tmp_path / "script.py").write_text(text)
    refused(floatsim("run", "script.py", "--duration", "1", "-o", "out.nc"), *words)
    assert case == "bad model" or "model script 'script.py'" in floatsim("check", "script.py")[2]
    assert not (tmp_path / "out.nc").exists()


def test_scripts_that_are_none(floatsim, tmp_path):
    refused(floatsim("check", "nothing.py"), "'nothing.py'", "no such file")
    (tmp_path / "model.yaml").write_text("def build(): pass")
    refused(floatsim("check", "model.yaml"), "'model.yaml'", "a Python file")
    (tmp_path / "folder.py").mkdir()
    refused(floatsim("check", "folder.py"), "'folder.py'", "no such file")


def test_interrupt(floatsim, tmp_path):
    (tmp_path / "script.py").write_text("def build():\n    raise KeyboardInterrupt\n")
    status, _, said = floatsim("check", "script.py")
    assert status == 130 and "interrupted" in said


# -- warnings and failures --------------------------------------------------------------------

FALLING = """
import floatsim as fs
def build():
    return fs.Model(parts=[fs.Body(name="stone", mass=1, inertia=(1, 1, 1))], sea=fs.Sea(depth=10))
"""
HEAVY = """
from pathlib import Path
from floatsim.study.script import load_model
def build(script, factor=2.0, cm_z=-2.0):
    model = load_model(script)
    platform = model.parts[0]
    heavy = platform.model_copy(update={"mass": factor * platform.mass, "center_of_mass": (0.0, 0.0, cm_z)})
    return model.model_copy(update={"parts": [heavy, *model.parts[1:]]})
"""


def test_no_equilibrium(floatsim, tmp_path):
    (tmp_path / "falling.py").write_text(FALLING)
    for command in (["static"], ["run", "--duration", "1"]):
        status, _, said = floatsim(*command, "falling.py", "-o", "out.nc")
        assert status == 1
        assert "warning: 'stone' is tied to nothing" in said and "failed: no static equilibrium" in said
        assert not (tmp_path / "out.nc").exists()


@pytest.mark.parametrize(
    "command",
    [["check"], ["static"], ["run", "--duration", "1"], ["decay", "--dof=heave", "--offset=1", "--duration=60"]],
)
def test_floaters_that_sink_or_capsize_are_warned_of(floatsim, tmp_path, command):
    (tmp_path / "heavy.py").write_text(HEAVY)
    _, _, said = floatsim(*command, "heavy.py", "-p", f"script={VOLTURNUS}")
    assert "warning: body 'platform' sinks: " in said and " kN of lift are missing" in said
    _, _, said = floatsim(*command, "heavy.py", "-p", f"script={VOLTURNUS}", "-p", "factor=1.0", "-p", "cm_z=20")
    assert "warning: body 'platform' has negative metacentric stiffness in pitch: -1.7" in said


LATER = """
import floatsim as fs
class Mine:
    def density(self, omega):
        return 1 / 0
def build():
    model = fs.PointMass(name="stone", mass=1, position=(0, 0, 0))
    waves = fs.IrregularWaves(spectrum=Mine(), seed=1)
    hook = fs.Ball(a="stone", b=(0, 0, 0))
    return fs.Model(parts=[model], joints=[hook], sea=fs.Sea(depth=10, waves=waves))
"""
BREAKS = """
import floatsim as fs
def build():
    zero = lambda t: (0.0, 0.0, 0.0)
    motion = fs.Motion(lambda t: (1 / (0 if 8.52 < t < 8.6 else 1e9), 0.0, 0.0), zero, zero)
    stone = fs.PointMass(name="stone", mass=1, position=(1e-9, 0, 0))
    return fs.Model(parts=[stone], joints=[fs.Prescribed(a="stone", motion=motion)], sea=fs.Sea(depth=10))
"""


def test_errors_of_a_script_that_come_later(floatsim, tmp_path):
    (tmp_path / "later.py").write_text(LATER)
    refused(floatsim("run", "later.py", "--duration", "1"), "model script 'later.py', line 5: ZeroDivisionError")
    (tmp_path / "breaks.py").write_text(BREAKS)
    status, _, said = floatsim("run", "breaks.py", "--duration", "10", "--dt", "0.05", "-o", "out.nc")
    assert status == 1 and "at t = 8.5 s: Motion: position(8.55) fails: ZeroDivisionError" in said, said
    with xr.open_dataset(tmp_path / "out.nc") as data:
        assert data.attrs["status"] == "failed" and "Motion: position" in data.attrs["failure"]
        assert data.sizes["time"] == 171 and all(np.isfinite(v.values).all() for v in data.data_vars.values())


# -- what comes out ---------------------------------------------------------------------------


def test_the_same_run_twice_gives_the_same_file(floatsim, tmp_path):
    for name in ("a.nc", "b.nc"):
        decay = ["decay", VOLTURNUS, "--dof", "heave", "--offset", "2", "--duration", "60", "-o", name]
        assert floatsim(*decay)[0] == 0
    with xr.open_dataset(tmp_path / "a.nc") as a, xr.open_dataset(tmp_path / "b.nc") as b:
        assert a.identical(b)  # names, values and attributes
        assert a.attrs["floatsim_version"] == fs.__version__
        assert len(a.attrs["input_hash"]) == 64 and a.attrs["model_script"] == "volturnus_s.py"
        assert a.attrs["status"] == "done" and a.attrs["failure"] == ""
        assert np.ptp(a["platform_position"].values[:, 2]) > 2.0  # it moved
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_the_input_hash_sees_every_input(tmp_path):
    script, data = tmp_path / "script.py", tmp_path / "hull.nc"
    data.write_bytes((MODELS / "volturnus_s_hydro.nc").read_bytes())
    script.write_text(Path(VOLTURNUS).read_text())
    parameters = {"hydro": str(data)}
    model = load_model(script, parameters)

    def now(parameters=parameters, **case):
        return input_hash(script, parameters, case, model)

    first = now(dt=0.1)
    assert now(dt=0.1) == first
    seen = {first, now(dt=0.2), now({**parameters, "elements": 20}, dt=0.1)}
    data.write_bytes(data.read_bytes() + b"\0")
    seen.add(now(dt=0.1))
    script.write_text(script.read_text() + "\n")
    seen.add(now(dt=0.1))
    assert len(seen) == 5


def test_run_and_plot(floatsim, tmp_path):
    run = ["run", CHAIN, "--duration", "2", "--interval", "0.5", "--precision", "float32", "--channel", "chain_tension"]
    status, said, _ = floatsim(*run, "-o", "chain.nc")
    assert status == 0 and "done: 2 s" in said
    with xr.open_dataset(tmp_path / "chain.nc") as data:
        assert data.time.values == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0])
        assert data.chain_tension.dtype == np.float32 and "chain_position" not in data
    status, said, _ = floatsim("plot", "chain.nc")
    assert status == 0 and (tmp_path / "chain.png").stat().st_size > 1000
    refused(floatsim("plot", "chain.nc", "-o", "nowhere/a.png"), "nowhere/a.png")
    refused(floatsim("plot", "chain.nc", "-o", "."), "'.' is a folder")
    refused(floatsim("plot", "chain.nc", "-o", "a.abc"), "'a.abc'", "not supported")


def test_results_can_be_read_while_a_database_is_in_use(tmp_path):
    """HDF5 takes its file locking from the environment once, when the first file is opened: here the database."""
    code = """
import subprocess, sys
import floatsim as fs
from floatsim.study.store import Channel, Writer
fs.HydroDatabase.read(sys.argv[1])
writer = Writer(sys.argv[2], [Channel("a", "a", "m")])
for k in range(300):
    writer.append(float(k), [k])
print(subprocess.run([sys.executable, "-c", sys.argv[3], sys.argv[2]], env={}, capture_output=True, text=True).stdout)
"""
    reader = "import sys, xarray; data = xarray.open_dataset(sys.argv[1]); print(data.sizes['time'], data.status)"
    arguments = [str(MODELS / "volturnus_s_hydro.nc"), str(tmp_path / "out.nc"), reader]
    environment = {k: v for k, v in os.environ.items() if k != "HDF5_USE_FILE_LOCKING"}
    said = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, env=environment)
    assert said.stdout.split() == ["256", "running"], said.stderr


# -- compiling --------------------------------------------------------------------------------


def test_a_cold_cache_is_said(floatsim, monkeypatch):
    monkeypatch.setattr("floatsim.jit.cache_is_cold", lambda: True)
    assert "compiling its kernels" in floatsim("check", PENDULUM)[2]
    monkeypatch.setattr("floatsim.jit.cache_is_cold", lambda: False)
    assert floatsim("check", PENDULUM)[2] == ""


def program(*arguments, **environment):
    code = "from floatsim.cli import main; main()"
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **environment})


@pytest.mark.slow
def test_first_run_compiles_and_says_so(tmp_path):
    first = program("check", PENDULUM, FLOATSIM_CACHE_DIR=str(tmp_path / "kernels"))
    assert first.returncode == 0 and "compiling its kernels" in first.stderr
    second = program("check", PENDULUM, FLOATSIM_CACHE_DIR=str(tmp_path / "kernels"))
    assert second.returncode == 0 and second.stderr == ""


def test_a_cache_that_cannot_be_written_is_said(tmp_path):
    (tmp_path / "file").write_text("in the way")
    said = program("--version", FLOATSIM_CACHE_DIR=str(tmp_path / "file" / "kernels"), TMPDIR=str(tmp_path))
    assert said.returncode == 0 and said.stdout == f"floatsim {fs.__version__}\n"
    assert "cannot write the kernel cache" in said.stderr and "set FLOATSIM_CACHE_DIR" in said.stderr


def test_the_reader_may_leave_early():
    code = "import sys; sys.argv = ['floatsim', 'check', sys.argv[1]]; from floatsim.cli import main; main()"
    with subprocess.Popen(
        [sys.executable, "-c", code, VOLTURNUS], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        process.stdout.close()
        assert "Traceback" not in process.stderr.read()


def test_static_warns_of_an_unstable_equilibrium(floatsim, tmp_path):
    """A rod balanced on its hinge: in equilibrium, and not for long."""
    script = tmp_path / "upright.py"
    script.write_text(
        "import floatsim as fs\n\n\n"
        "def build():\n"
        "    rod = fs.Body(name='rod', mass=1.0, inertia=(0.1, 0.1, 0.1), center_of_mass=(0.0, 0.0, 1.0))\n"
        "    return fs.Model(parts=[rod], joints=[fs.Ball(a='rod', b=(0.0, 0.0, 0.0))], sea=fs.Sea(depth=10.0))\n"
    )
    status, _, said = floatsim("static", script)
    assert status == 0
    assert "warning: the equilibrium is unstable: rod" in said
