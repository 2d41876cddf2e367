"""The shallow-water model on C-grid Voronoi meshes: tendency, time stepping, invariants and the run loop."""

from swe.equations.model import ShallowWaterModel
from swe.equations.terms import Forcing
from swe.errors import InputError, RunError
from swe.forcing.drag import LinearDrag, QuadraticDrag
from swe.forcing.relaxation import ThicknessRelaxation
from swe.forcing.viscosity import Viscosity
from swe.forcing.wind import WindStress
from swe.run.simulation import Simulation
from swe.run.watch import Callback
from swe.state import State

__all__ = [
    "Callback",
    "Forcing",
    "InputError",
    "LinearDrag",
    "QuadraticDrag",
    "RunError",
    "ShallowWaterModel",
    "Simulation",
    "State",
    "ThicknessRelaxation",
    "Viscosity",
    "WindStress",
]
