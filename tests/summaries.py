"""Made-up summaries of case matrices, in the form of a summary.nc, for tests of the report."""

from __future__ import annotations

import itertools
import json
from typing import Any

import numpy as np
import xarray

DOFS = ["surge", "sway", "heave", "roll", "pitch", "yaw"]
LOOP = [[-58.0, -6.0], [30.0, -52.0], [36.0, -46.0], [36.0, 46.0], [30.0, 52.0], [-58.0, 6.0]]
OUTLINE = {"platform": {"loops": [LOOP], "points": {"fairlead_1": [-58.0, 0.0]}}}


def product(**columns: Any) -> dict[str, np.ndarray]:
    """All combinations of the columns' values."""
    rows = list(itertools.product(*columns.values()))
    return {name: np.array([row[k] for row in rows]) for k, name in enumerate(columns)}


def dataset(variables: dict[str, Any], data: dict[str, Any], lost: dict[int, tuple[str, str]] | None = None,
            **attributes: Any) -> xarray.Dataset:  # fmt: skip
    """A summary: data name -> (dims, values, units); lost: case -> reason and message."""
    lost = lost or {}
    n = len(next(iter(variables.values())))
    values = {}
    for name, (dims, x, unit) in data.items():
        x = np.array(x, dtype=float)
        if dims[0] == "case" and name != "wall_time":
            x[list(lost)] = np.nan
        values[name] = (dims, x, {"units": unit, "long_name": name})
    text = {
        "case_id": [f"case_{k:04d}-{k * 7919 % 16**6:06x}" for k in range(n)],
        "status": ["failed" if k in lost else "done" for k in range(n)],
        "failure": [lost.get(k, ("", ""))[0] for k in range(n)],
        "failure_message": [lost.get(k, ("", ""))[1] for k in range(n)],
    }
    coords = {name: ("case", x) for name, x in variables.items()} | {k: ("case", np.array(v)) for k, v in text.items()}
    return xarray.Dataset(values, coords, attributes)


def platform(variables: dict[str, np.ndarray], lost: dict[int, tuple[str, str]] | None = None, seed: int = 1,
             moorings: int = 3, cables: int = 2, elements: int = 30, **attributes: Any) -> xarray.Dataset:  # fmt: skip
    """A moored platform with power cables: it goes with the wind, and a little with the current."""
    n = len(next(iter(variables.values())))
    r = np.random.default_rng(seed)

    def column(name: str, default: float) -> np.ndarray:
        return np.asarray(variables.get(name, np.full(n, default)), dtype=float)

    U, b = column("wind_speed", 12.0), np.radians(column("wind_heading_deg", 0.0))
    V, c = column("current_speed", 0.0), np.radians(column("current_heading_deg", 0.0))
    hs = column("hs", 4.0)
    pull = 1.6 * U * np.exp(-0.5 * ((U - 11.0) / 5.0) ** 2) + 4.0
    mean = np.zeros((n, 6))
    mean[:, 0] = pull * np.cos(b) + 18.0 * V * np.cos(c) + r.normal(0.0, 0.1, n)
    mean[:, 1] = pull * np.sin(b) + 18.0 * V * np.sin(c) + r.normal(0.0, 0.1, n)
    mean[:, 2] = 0.1 + 0.01 * r.normal(size=n)
    mean[:, 4], mean[:, 3] = 0.004 * pull * np.cos(b), -0.004 * pull * np.sin(b)
    mean[:, 5] = 0.01 * np.sin(3.0 * b)
    along, across = 0.35 * hs + 0.4, 0.12 * hs + 0.3
    std = np.zeros((n, 6))
    std[:, 0] = np.sqrt((along * np.cos(b)) ** 2 + (across * np.sin(b)) ** 2)
    std[:, 1] = np.sqrt((along * np.sin(b)) ** 2 + (across * np.cos(b)) ** 2)
    std[:, 2:] = [0.3, 0.01, 0.012, 0.01]
    std[:, 2] *= hs
    wide = (3.2 + 0.3 * r.random((n, 1))) * std
    data: dict[str, Any] = {
        "platform_position_mean": (("case", "dof"), mean, "mixed"),
        "platform_position_std": (("case", "dof"), std, "mixed"),
        "platform_position_min": (("case", "dof"), mean - wide, "mixed"),
        "platform_position_max": (("case", "dof"), mean + wide, "mixed"),
        "platform_position_surge_sway_cov": (("case",), (along**2 - across**2) * np.sin(b) * np.cos(b), "m2"),
        "wall_time": (("case",), r.gamma(30.0, 4.0, n), "s"),
        "steps": (("case",), np.full(n, 7000.0), "1"),
        "newton_iterations": (("case",), r.normal(17000.0, 300.0, n), "1"),
    }
    for k in range(moorings + cables):
        chain = k < moorings
        line = f"mooring_{k + 1}" if chain else f"cable_{k - moorings + 1}"
        s = np.linspace(0.0, 821.0 if chain else 226.0, elements + 1)
        middle = 0.5 * (s[1:] + s[:-1])
        lead = np.pi + 2.0 * np.pi * k / 3.0 if chain else np.pi * (k - moorings)
        away = mean[:, 0] * np.cos(lead) + mean[:, 1] * np.sin(lead)
        if chain:
            T = 1.2e6 * np.exp(-away / 18.0)[:, None] + 400.0 * middle
            load = 2.2e7
        else:
            T = 1.0e3 + 1.55e4 * (1.0 - middle / 226.0) ** 2 + 120.0 * np.abs(away)[:, None]
            load = 1.0e5
        rise = T * (0.08 * hs[:, None] + 0.05)
        e, v = f"{line}_element", f"{line}_node"
        data[f"{line}_tension_mean"] = ("case", e), T, "N"
        data[f"{line}_tension_std"] = ("case", e), 0.25 * rise, "N"
        data[f"{line}_tension_max"] = ("case", e), T + rise, "N"
        data[f"{line}_tension_min"] = ("case", e), T - 0.6 * rise, "N"
        data[f"{line}_tension_utilisation_max"] = ("case", e), (T + rise) / load, "1"
        data[f"{line}_arc_length"] = (v,), s, "m"
        data[f"{line}_element_arc_length"] = (e,), middle, "m"
        if not chain:
            bend = 0.05 + 0.06 * np.exp(-(((s - 70.0) / 20.0) ** 2)) + 0.05 * np.exp(-(((s - 130.0) / 15.0) ** 2))
            bend = bend * (1.0 + 0.004 * np.abs(away)[:, None])
            data[f"{line}_curvature_mean"] = ("case", v), bend, "1/m"
            data[f"{line}_curvature_max"] = ("case", v), bend * (1.05 + 0.03 * hs[:, None]), "1/m"
            data[f"{line}_curvature_min"] = ("case", v), bend * (0.95 - 0.03 * hs[:, None]), "1/m"
            data[f"{line}_curvature_utilisation_max"] = ("case", v), bend * (1.05 + 0.03 * hs[:, None]) / 0.2, "1"
            data[f"{line}_bending_moment_max"] = ("case", v), 1e4 * bend, "N m"
    power = 15e6 * np.clip((U / 10.6) ** 3, 0.0, 1.0)
    for name, x, unit, swing in (
        ("power", power, "W", 0.1), ("thrust", 1e5 * pull, "N", 0.2),
        ("speed", 0.79 * np.clip(U / 10.6, 0, 1), "rad/s", 0.05),
        ("pitch", np.radians(np.clip(2.2 * (U - 10.6), 0.0, None)), "rad", 0.3),
    ):  # fmt: skip
        for kind, shift in (("mean", 0.0), ("min", -swing), ("max", swing)):
            data[f"rotor_{name}_{kind}"] = ("case",), x * (1.0 + shift), unit
        data[f"rotor_{name}_std"] = ("case",), 0.3 * swing * x, unit
    found = dataset(variables, data, lost, outlines=json.dumps(OUTLINE), duration=600.0, ramp=200.0, dt=0.1,
                    model_script="models/volturnus_s_82m.py", floatsim_version="0.5.0", **attributes)  # fmt: skip
    found = found.assign_coords(dof=DOFS)
    return found.set_coords([n for n in found.data_vars if str(n).endswith("arc_length")])


def screening(lost: dict[int, tuple[str, str]] | None = None) -> xarray.Dataset:
    """Like the screening of Verelst et al. 2024: 9 wind headings, 6 cable angles, 3 seeds."""
    v = product(
        study_wind_heading_deg=list(range(0, 121, 15)), study_cable_angle_deg=list(range(15, 91, 15)), seed=[1, 2, 3]
    )
    v["wind_heading_deg"] = -v["study_wind_heading_deg"]
    v["wind_speed"], v["hs"], v["tp"] = np.full(162, 12.0), np.full(162, 12.5), np.full(162, 18.4)
    return platform(v, lost, name="screening_82m")


def operational(seeds: int = 3, elements: int = 30) -> xarray.Dataset:
    """Like the operational table of Verelst et al. 2024: 750 conditions times seeds."""
    turned = [0, -30, -60, -90, -120]
    v = product(wind_speed=[8.0, 12.0, 16.0], wind_heading_deg=turned, misalignment_deg=[-40, -20, 0, 20, 40],
                current_speed=[0.15, 0.25], current_heading_deg=turned, seed=list(range(1, seeds + 1)))  # fmt: skip
    v["wave_heading_deg"] = v["wind_heading_deg"] + v["misalignment_deg"]
    v["hs"] = 0.4 * v["wind_speed"]
    v["tp"] = 1.33 + 4.74 * np.sqrt(v["hs"])
    return platform(v, {700: ("diverged", "no convergence at 321.4 s")}, elements=elements, name="operational_82m")


def converter() -> xarray.Dataset:
    """A wave-energy converter of two bodies with a power take-off in a scatter table; no lines."""
    v = product(hs=[1.0, 2.0, 3.0], tp=[6.0, 8.0, 10.0, 12.0])
    n = 12
    power = 4e4 * v["hs"] ** 2 * np.exp(-(((v["tp"] - 8.0) / 3.0) ** 2))
    data: dict[str, Any] = {"wall_time": (("case",), np.linspace(3.0, 5.0, n), "s")}
    for body, share in (("float", 0.5), ("spar", 0.1)):
        heave = np.zeros((n, 6))
        heave[:, 2] = share * v["hs"]
        for kind, x in (("mean", 0.01 * heave), ("std", 0.5 * heave), ("min", -heave), ("max", heave)):
            data[f"{body}_position_{kind}"] = ("case", "dof"), x, "mixed"
    for kind, factor in (("mean", 1.0), ("std", 1.1), ("min", 0.0), ("max", 6.0)):
        data[f"pto_power_{kind}"] = ("case",), factor * power, "W"
        data[f"pto_force_{kind}"] = ("case",), factor * 1e5 * v["hs"], "N"
    data["pto_force_del"] = ("case",), 2e5 * v["hs"], "N"
    return dataset(v, data, name="scatter").assign_coords(dof=DOFS)


def decay() -> xarray.Dataset:
    """Decay tests of one body."""
    v = product(dof=["surge", "heave", "pitch"], offset=[1.0, 5.0], depth=[82.0, 200.0])
    n = 12
    period = np.array([{"surge": 142.0, "heave": 20.4, "pitch": 27.7}[d] for d in v["dof"]]) + 0.1 * v["offset"]
    data = {
        "decay_period": (("case",), period, "s"),
        "decay_damping_ratio": (("case",), np.linspace(0.02, 0.06, n), "1"),
        "wall_time": (("case",), np.full(n, 8.0), "s"),
    }
    lost = {3: ("raised", "no release: <b>pitch</b> & more")}
    return dataset({"release": v["dof"], "offset": v["offset"], "depth": v["depth"]}, data, lost, name="decay")
