"""floatsim: dynamics of floating wind turbines, wave-energy converters and their cables.

    import floatsim as fs

The public names, one import path each. Light to import: xarray, netCDF4, matplotlib and rich are
loaded where they are used.
"""

from floatsim.errors import CaseError, FloatsimError, ModelError, SolveFailed
from floatsim.hydro.floater import PotentialFlow
from floatsim.joints.ball import Ball
from floatsim.joints.clamp import Clamp
from floatsim.joints.prescribed import Motion, Prescribed
from floatsim.joints.weld import Weld
from floatsim.model import Expected, Model
from floatsim.parts.body import Body
from floatsim.parts.line import Line, Section
from floatsim.parts.point_mass import PointMass
from floatsim.parts.spring import Spring
from floatsim.sea.site import Current, Sea, Seabed
from floatsim.solve.scheme import Scheme, generalised_alpha, hht, newmark
from floatsim.solve.static import StaticReport, solve_static
from floatsim.solve.step import StepReport, Stepper, step
from floatsim.system.state import State
from floatsim.system.system import System, assemble

__version__ = "0.1.0"

__all__ = [
    "Ball", "Body", "CaseError", "Clamp", "Current", "Expected", "FloatsimError", "Line", "Model", "ModelError",
    "Motion", "PointMass", "PotentialFlow", "Prescribed", "Scheme", "Sea", "Seabed", "Section", "SolveFailed", "Spring", "State",
    "StaticReport", "StepReport", "Stepper", "System", "Weld", "assemble", "generalised_alpha", "hht", "newmark",
    "solve_static", "step",
]  # fmt: skip
