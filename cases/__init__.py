"""Test cases: parameters, initial state and, where it is known, exact solution; one module per paper."""

from cases.base import Case, parameter
from cases.basins import KelvinWave, Seiche
from cases.finding.registry import CASES, PLANE_CASES, find_case
from cases.galewsky import Galewsky
from cases.gyres import DoubleGyre, Stommel
from cases.hollingsworth import Hollingsworth
from cases.lake_at_rest import LakeAtRest
from cases.munk import Munk
from cases.plane.adjustment import GeostrophicAdjustment
from cases.plane.base import PlaneCase
from cases.plane.channel import KelvinChannel
from cases.plane.gyres import MunkBox, StommelBox
from cases.plane.manufactured import Manufactured
from cases.plane.vortices import DualVortex
from cases.plane.waves import InertiaGravityWave
from cases.williamson import Williamson1, Williamson2, Williamson5, Williamson6

__all__ = [
    "CASES",
    "PLANE_CASES",
    "Case",
    "DoubleGyre",
    "DualVortex",
    "Galewsky",
    "GeostrophicAdjustment",
    "Hollingsworth",
    "InertiaGravityWave",
    "KelvinChannel",
    "KelvinWave",
    "LakeAtRest",
    "Manufactured",
    "Munk",
    "MunkBox",
    "PlaneCase",
    "Seiche",
    "Stommel",
    "StommelBox",
    "Williamson1",
    "Williamson2",
    "Williamson5",
    "Williamson6",
    "find_case",
    "parameter",
]
