"""What a matrix of cases costs beside its runs.

    python tests/benchmarks/bench_cases.py [throughput|overhead|collect] [CASES]

throughput: steps of all cases per second with two workers against one (bar 1.8, on an idle machine of two cores or
more). overhead: processor time of a case of 600 s, by the runner's worker, against the plain run of the same model
(bar 2 %). collect: time and memory of a summary of 2250 cases made from the statistics of one (bars 60 s, 2 GB). The
model is VolturnusS with cables in 82 m, in waves, without wind.
"""

from __future__ import annotations

import json
import resource
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import floatsim as fs
from floatsim.cases.case import Case, RunSettings
from floatsim.cases.folder import Folder
from floatsim.cases.run_case import run_case
from floatsim.cases.runner import run
from floatsim.study.script import load_model

MODEL = Path(__file__).parents[2] / "models" / "volturnus_s_82m.py"
SETTINGS = RunSettings(duration=600.0, ramp=200.0, dt=0.1, interval=0.2)


def case(number: int) -> Case:
    """One of the sea of the screening, by its seed."""
    waves = {"spectrum": "jonswap", "hs": 12.5, "tp": 18.4, "heading_deg": 0.0, "seed": number + 1}
    return Case(number, f"seed{number + 1}", {"seed": number + 1}, str(MODEL), {"cable_angle_deg": 30.0},
                {"waves": waves}, SETTINGS, "benchmark")  # fmt: skip


def _silent(line: str) -> None:
    """Progress is not wanted here."""


def throughput(cases: int) -> None:
    """Case-steps per second of two workers and of one."""
    steps = cases * SETTINGS.total / SETTINGS.dt
    rates = {}
    for jobs in (1, 2):
        with tempfile.TemporaryDirectory() as place:
            own = [case(k) for k in range(cases)]
            run(own[:jobs], place, jobs=jobs, say=_silent)  # statics are kept and kernels compiled
            began = time.perf_counter()
            summary = run([*own[:jobs], *(case(100 + k) for k in range(cases))], place, jobs=jobs, say=_silent)
            rates[jobs] = steps / (time.perf_counter() - began)
            assert summary.done == cases + jobs, summary.lines()
        print(f"{jobs} workers: {rates[jobs]:.0f} case-steps per second, start of the workers included")
    print(f"two workers are {rates[2] / rates[1]:.2f} times as fast as one")


def overhead(repeats: int) -> None:
    """Processor time of the runner's work for a case, over that of the plain run. In turns: machines have moods."""
    with tempfile.TemporaryDirectory() as place:
        folder = Folder(place)
        folder.prepare()

        def plain(number: int) -> None:
            own = case(number)
            values = own.environment["waves"]
            waves = fs.IrregularWaves(spectrum=fs.Jonswap(hs=values["hs"], tp=values["tp"]), seed=values["seed"],
                                      duration=SETTINGS.total)  # fmt: skip
            model = load_model(MODEL, {**own.parameters, "waves": waves})
            result = fs.simulate(model, SETTINGS.total, SETTINGS.dt, interval=SETTINGS.interval)
            assert result.status == "done", result.failure

        def by_runner(number: int) -> None:
            record = run_case(case(number), folder.path)
            assert record.status == "done", record.message

        plain(0), by_runner(0)
        spent: dict[Callable[[int], None], float] = {plain: 0.0, by_runner: 0.0}
        for k in range(1, repeats + 1):
            for function in spent:
                began = time.process_time()
                function(k)
                spent[function] += (time.process_time() - began) / repeats
    more = spent[by_runner] - spent[plain]
    print(f"plain run {spent[plain]:.2f} s, case {spent[by_runner]:.2f} s of processor time: {more:+.3f} s, "
          f"{100.0 * more / spent[plain]:+.2f} % (statistics of all channels included)")  # fmt: skip


def collecting(cases: int) -> None:
    """Summary of many cases with the statistics of one."""
    from floatsim.cases.collect import collect

    with tempfile.TemporaryDirectory() as place:
        folder = Folder(place)
        folder.prepare()
        first = replace(case(0), run=replace(SETTINGS, duration=40.0, ramp=10.0))
        assert run_case(first, place).status == "done"
        every = [replace(first, number=k, slug=f"case{k}", variables={"seed": k}) for k in range(cases)]
        for item in every:
            shutil.copy(folder.statistics(first.id), folder.statistics(item.id))
        folder.write_matrix(every, "benchmark", "", {})
        began = time.perf_counter()
        path = collect(place)
        spent = time.perf_counter() - began
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(json.dumps({"cases": cases, "seconds": round(spent, 1), "peak_GB": round(most, 2),
                          "file_MB": round(path.stat().st_size / 1e6, 1)}))  # fmt: skip


if __name__ == "__main__":
    what, number = (sys.argv[1:] + ["overhead"])[0], int(sys.argv[2]) if len(sys.argv) > 2 else 0
    {"throughput": lambda: throughput(number or 4), "overhead": lambda: overhead(number or 3),
     "collect": lambda: collecting(number or 2250)}[what]()  # fmt: skip
