"""What a run's PTOs absorbed, on average and against what the waves brought."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from floatsim.errors import CaseError
from floatsim.study.simulate import Run


def mean_power(run: Run, pto: str | Sequence[str], since: float = 0.0) -> float:
    """Mean absorbed power [W] of a PTO, or of several together, from time `since` [s] to the end of the run.

    It is the difference of the PTO's energy over the time between, and so exact for the run's own steps however coarse
    the output is. Raises CaseError for a PTO that is not there and for a time that leaves fewer than two samples.
    """
    names = [pto] if isinstance(pto, str) else list(pto)
    first = int(np.searchsorted(run.time, since - 1e-9))
    if len(run.time) - first < 2:
        raise CaseError(f"mean_power: since is {since:g} s; the run has results from {run.time[0]:g} to "
                        f"{run.time[-1]:g} s and two samples are needed")  # fmt: skip
    energy = np.sum([run.series(f"{name}_energy") for name in names], axis=0)
    return float((energy[-1] - energy[first]) / (run.time[-1] - run.time[first]))


def wave_power(run: Run) -> float:
    """Mean energy flux of the run's waves per metre of crest [W/m], all headings together: sum of rho g a^2/2 c_g.

    Group velocity from linear theory at the water depth. Raises CaseError for a run without waves.
    """
    system = run.sampler.system
    waves, sea, g = system.waves, system.model.sea, system.model.gravity
    if waves is None:
        raise CaseError("wave_power: the run has no waves")
    kh = waves.wave_number * (waves.depth if math.isfinite(waves.depth) else 0.0)
    finite = (kh > 0.0) & (kh < 300.0)
    x = np.where(finite, 2.0 * kh, 1.0)
    group = 0.5 * waves.omega / waves.wave_number * np.where(finite, 1.0 + x / np.sinh(x), 1.0)
    return float(0.5 * sea.density * g * np.sum(waves.amplitude**2 * group))


def capture_width(run: Run, pto: str | Sequence[str], since: float = 0.0) -> float:
    """Mean power of a PTO, or of several together, over the waves' energy flux [m]. since [s], errors: `mean_power`."""
    return mean_power(run, pto, since) / wave_power(run)
