"""The shallow-water model on C-grid Voronoi meshes: tendency, time stepping, invariants and the run loop."""

from swe.equations.model import ShallowWaterModel
from swe.equations.terms import Forcing
from swe.errors import InputError, RunError
from swe.run.simulation import Simulation
from swe.run.watch import Callback
from swe.state import State

__all__ = ["Callback", "Forcing", "InputError", "RunError", "ShallowWaterModel", "Simulation", "State"]
