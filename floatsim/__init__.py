"""floatsim: dynamics of floating wind turbines, wave-energy converters and their cables.

    import floatsim as fs

The public names, one import path each. Light to import: xarray, netCDF4, matplotlib and rich are
loaded where they are used.
"""

from floatsim.errors import CaseError, FloatsimError, ModelError, SolveFailed
from floatsim.hydro.database import HydroDatabase, check_database
from floatsim.hydro.floater import PotentialFlow
from floatsim.hydro.hull import Hull
from floatsim.hydro.wamit import read_wamit
from floatsim.joints.ball import Ball
from floatsim.joints.clamp import Clamp
from floatsim.joints.prescribed import Motion, Prescribed
from floatsim.joints.weld import Weld
from floatsim.laws.engineering import Engineering
from floatsim.laws.moment_table import MomentTable
from floatsim.laws.static_dynamic import StaticDynamic
from floatsim.laws.tension_table import TensionTable
from floatsim.model import Expected, Model
from floatsim.parts.body import Body
from floatsim.parts.line import Line
from floatsim.parts.member import Disc, Member
from floatsim.parts.point_buoy import PointBuoy
from floatsim.parts.point_mass import PointMass
from floatsim.parts.section import Attachment, BendStiffener, Break, Piece, Section
from floatsim.parts.shapes import Arc, Catenary, Nodes, Straight, ThreeCircles
from floatsim.parts.spring import Spring
from floatsim.sea.elevation_series import ElevationSeries
from floatsim.sea.focused import FocusedWave
from floatsim.sea.seabed import Bathymetry, Seabed
from floatsim.sea.site import Current, CurrentTable, PowerLaw, Sea
from floatsim.sea.spectra import (
    Bretschneider,
    Jonswap,
    OchiHubble,
    PiersonMoskowitz,
    SpectrumTable,
    Torsethaugen,
    WhiteNoise,
)
from floatsim.sea.waves import CombinedWaves, IrregularWaves, RegularWave, WaveComponents
from floatsim.solve.modes import Mode, natural_modes
from floatsim.solve.scheme import Scheme, generalised_alpha, hht, newmark
from floatsim.solve.static import StaticReport, solve_static
from floatsim.solve.step import Stepper, StepReport, step
from floatsim.study.lazy_wave import diameter_from_weights, section_lengths, sizing
from floatsim.study.moordyn import MoorDynImport, read_moordyn
from floatsim.study.ranges import RangeGraph, range_graph
from floatsim.study.release import DecayTest, decay_test
from floatsim.study.simulate import Run, simulate
from floatsim.system.state import State
from floatsim.system.system import System, assemble
from floatsim.version import __version__

__all__ = [
    "__version__", "Arc", "assemble", "Attachment", "Ball", "Bathymetry", "BendStiffener", "Body", "Break",
    "Bretschneider", "CaseError", "Catenary", "check_database", "Clamp", "CombinedWaves", "Current", "CurrentTable",
    "decay_test", "DecayTest", "diameter_from_weights", "Disc", "ElevationSeries", "Engineering", "Expected",
    "FloatsimError", "FocusedWave", "generalised_alpha", "hht", "Hull", "HydroDatabase", "IrregularWaves", "Jonswap",
    "Line", "Member", "Mode", "Model", "ModelError", "MomentTable", "MoorDynImport", "Motion", "natural_modes",
    "newmark", "Nodes", "OchiHubble", "Piece", "PiersonMoskowitz", "PointBuoy", "PointMass", "PotentialFlow",
    "PowerLaw", "Prescribed", "range_graph", "RangeGraph", "read_moordyn", "read_wamit", "RegularWave", "Run",
    "Scheme", "Sea", "Seabed", "Section", "section_lengths", "simulate", "sizing", "solve_static", "SolveFailed",
    "SpectrumTable", "Spring", "State", "StaticDynamic", "StaticReport", "step", "Stepper", "StepReport", "Straight",
    "System", "TensionTable", "ThreeCircles", "Torsethaugen", "WaveComponents", "Weld", "WhiteNoise",
]  # fmt: skip
