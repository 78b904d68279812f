"""floatsim: dynamics of floating wind turbines, wave-energy converters and their cables.

    import floatsim as fs

The public names, one import path each. Light to import: xarray, netCDF4, matplotlib and rich are
loaded where they are used.
"""

from floatsim.cases.case import Case, RunSettings
from floatsim.cases.environment import build_case
from floatsim.cases.matrix import Matrix, read_matrix
from floatsim.errors import CaseError, FloatsimError, ModelError, SolveFailed
from floatsim.hydro.check import check_database
from floatsim.hydro.database import HydroDatabase
from floatsim.hydro.far_field import FreeFloating
from floatsim.hydro.floater import PotentialFlow
from floatsim.hydro.hull import Hull
from floatsim.hydro.qtf import QTF, read_wamit_qtf
from floatsim.hydro.read import read_hydro
from floatsim.hydro.wamit import read_wamit
from floatsim.joints.ball import Ball
from floatsim.joints.clamp import Clamp
from floatsim.joints.cylindrical import Cylindrical
from floatsim.joints.hinge import Hinge
from floatsim.joints.lock import Lock
from floatsim.joints.point_on_line import PointOnLine
from floatsim.joints.prescribed import Motion, Prescribed
from floatsim.joints.rod import Rod
from floatsim.joints.slider import Slider
from floatsim.joints.universal import Universal
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
from floatsim.parts.pto import PTO
from floatsim.parts.rotor import Rotor
from floatsim.parts.section import Attachment, BendStiffener, Break, Piece, Section
from floatsim.parts.shapes import Arc, Catenary, Nodes, Straight, ThreeCircles
from floatsim.parts.spring import Spring
from floatsim.parts.tower import Tower
from floatsim.pto_laws.coulomb import Coulomb
from floatsim.pto_laws.end_stop import EndStop
from floatsim.pto_laws.force_table import ForceTable
from floatsim.pto_laws.hydraulic import Hydraulic
from floatsim.pto_laws.linear import Linear
from floatsim.pto_laws.one_sided import CompressionOnly, TensionOnly
from floatsim.pto_laws.polynomial import Polynomial
from floatsim.pto_laws.taut_mooring import TautMooring
from floatsim.pto_laws.user_law import UserLaw
from floatsim.rotor.control import Controller
from floatsim.rotor.surface import PerformanceSurface
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
from floatsim.study.energy import Energy
from floatsim.study.frequency import FrequencyResponse, frequency_response
from floatsim.study.lazy_wave import diameter_from_weights, section_lengths, sizing
from floatsim.study.moordyn import MoorDynImport, read_moordyn
from floatsim.study.power import capture_width, mean_power, wave_power
from floatsim.study.power_matrix import PowerMatrix, power_matrix, read_occurrence
from floatsim.study.ranges import RangeGraph, range_graph
from floatsim.study.release import DecayTest, decay_test
from floatsim.study.simulate import Run, resume, simulate
from floatsim.study.statistics import Statistics, StatisticsSettings, statistics
from floatsim.system.state import State
from floatsim.system.system import System, assemble
from floatsim.version import __version__
from floatsim.wind.inflow import Wind
from floatsim.wind.turbulence import Kaimal

__all__ = [
    "__version__", "Arc", "assemble", "Attachment", "Ball", "Bathymetry", "BendStiffener", "Body", "Break",
    "Bretschneider", "build_case", "capture_width", "Case", "CaseError", "Catenary", "check_database", "Clamp",
    "CombinedWaves", "CompressionOnly", "Controller", "Coulomb", "Current", "CurrentTable", "Cylindrical",
    "decay_test", "DecayTest", "diameter_from_weights", "Disc", "ElevationSeries", "EndStop", "Energy", "Engineering",
    "Expected", "FloatsimError", "FocusedWave", "ForceTable", "FreeFloating", "frequency_response",
    "FrequencyResponse", "generalised_alpha", "hht", "Hinge", "Hull", "Hydraulic", "HydroDatabase", "IrregularWaves",
    "Jonswap", "Kaimal", "Line", "Linear", "Lock", "Matrix", "mean_power", "Member", "Mode", "Model", "ModelError",
    "MomentTable", "MoorDynImport", "Motion", "natural_modes", "newmark", "Nodes", "OchiHubble", "PerformanceSurface",
    "Piece", "PiersonMoskowitz", "PointBuoy", "PointMass", "PointOnLine", "Polynomial", "PotentialFlow",
    "power_matrix", "PowerLaw", "PowerMatrix", "Prescribed", "PTO", "QTF", "range_graph", "RangeGraph", "read_hydro",
    "read_matrix", "read_moordyn", "read_occurrence", "read_wamit", "read_wamit_qtf", "RegularWave", "resume", "Rod",
    "Rotor", "Run", "RunSettings", "Scheme", "Sea", "Seabed", "Section", "section_lengths", "simulate", "sizing",
    "Slider", "solve_static", "SolveFailed", "SpectrumTable", "Spring", "State", "StaticDynamic", "StaticReport",
    "Statistics", "statistics", "StatisticsSettings", "step", "Stepper", "StepReport", "Straight", "System",
    "TautMooring", "TensionOnly", "TensionTable", "ThreeCircles", "Torsethaugen", "Tower", "Universal", "UserLaw",
    "wave_power", "WaveComponents", "Weld", "WhiteNoise", "Wind",
]  # fmt: skip
