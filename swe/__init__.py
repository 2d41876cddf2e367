"""The shallow-water model on C-grid Voronoi meshes: tendency, time stepping, invariants and the run loop."""

from swe.equations.model import ShallowWaterModel
from swe.errors import InputError, RunError
from swe.run.simulation import Simulation
from swe.state import State

__all__ = ["InputError", "RunError", "ShallowWaterModel", "Simulation", "State"]
