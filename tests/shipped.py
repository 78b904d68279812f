"""The model scripts that come with floatsim, as modules."""

import importlib.util
from pathlib import Path
from types import ModuleType

MODELS = Path(__file__).parents[1] / "models"
HYDRO = MODELS / "volturnus_s_hydro.nc"


def load(name: str) -> ModuleType:
    """`models/NAME.py`."""
    spec = importlib.util.spec_from_file_location(name, MODELS / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
