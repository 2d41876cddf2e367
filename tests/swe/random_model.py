"""Models with random fields, on which identities must hold, and derivatives of the integrals along a tendency."""

import numpy as np

from mesh import VoronoiMesh
from mesh.discrete.walls import wall_edges
from swe import ShallowWaterModel, State
from swe.diagnostics.budgets import RATES
from swe.diagnostics.invariants import measure_invariants
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.terms import Term

RADIUS = 6.4e6


def random_model(
    mesh: VoronoiMesh, *terms: Term, seed: int, scheme: type[Scheme] = Ringler2010, wall_slip: float = 0.0
) -> tuple[ShallowWaterModel, State]:
    """A model on `mesh` in metres, and a state at rest at walls."""
    random = np.random.default_rng(seed)
    topography = random.uniform(0.0, 500.0, mesh.n_cells)
    coriolis = random.uniform(-1e-4, 1e-4, mesh.n_vertices)
    fields = mesh.scaled(RADIUS), topography, coriolis, 9.8
    model = ShallowWaterModel(*fields, scheme=scheme, terms=terms, wall_slip=wall_slip)
    state = State(random.uniform(900.0, 1100.0, mesh.n_cells), random.uniform(-30.0, 30.0, mesh.n_edges))
    state.normal_velocity[wall_edges(mesh)] = 0.0
    return model, state


def derivatives_along(model: ShallowWaterModel, state: State, slope: State) -> dict[str, tuple[float, float]]:
    """Central differences of the integrals along `slope`, and the round-off in them, by the names of the integrals."""

    def integrals(time: float) -> dict[str, float]:
        there = State(state.thickness + time * slope.thickness, state.normal_velocity + time * slope.normal_velocity)
        found = measure_invariants(model, there, model.diagnose(there))
        return {name: getattr(found, name) for name in RATES}

    step = 1e-2 / np.abs(slope.normal_velocity).max()
    after, before = integrals(step), integrals(-step)
    sizes = {name: abs(value) for name, value in after.items()}
    sizes["absolute_vorticity"] = float(np.abs(model.coriolis) @ model.mesh.area_triangle)
    return {name: ((after[name] - before[name]) / (2.0 * step), 1e-14 * sizes[name] / step) for name in RATES}
