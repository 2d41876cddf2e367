"""The model on a mesh that a coast clips: a lake stays at rest, and mass and energy are kept."""

import numpy as np
import pytest

from cases import LakeAtRest
from mesh import VoronoiMesh
from mesh.coast.sea_mesh import sea_mesh
from swe import Simulation
from swe.equations.schemes import Ringler2010
from swe.tiles.fused import FusedRungeKutta
from tests.mesh.coast.shores import converged, wavy_sea
from tests.swe.random_model import random_model


@pytest.fixture(scope="module")
def sea() -> VoronoiMesh:
    found = converged(wavy_sea(400), 400, 1e-3)
    return sea_mesh(found.sea, found.result.points)


def test_a_lake_up_to_the_coast_stays_at_rest(sea: VoronoiMesh) -> None:
    simulation = Simulation(sea, LakeAtRest())
    simulation.run(days=1.0, progress=False)
    assert np.abs(simulation.state.normal_velocity).max() < 1e-11


def test_mass_and_energy_are_kept(sea: VoronoiMesh) -> None:
    model, state = random_model(sea, seed=8, scheme=Ringler2010)
    plain, fused = state.empty_like(), state.empty_like()
    model.tendency(state, plain)
    FusedRungeKutta(model).tendency(state, fused)
    np.testing.assert_allclose(fused.normal_velocity, plain.normal_velocity, rtol=0, atol=1e-16)
    mesh, diagnosis, flux = model.mesh, model.diagnose(state), np.empty(sea.n_edges)
    model.scheme.flux(state.thickness, state.normal_velocity, flux)
    bernoulli = 9.8 * (state.thickness + model.topography) + diagnosis.kinetic_energy
    work = mesh.dc_edge * mesh.dv_edge * flux * plain.normal_velocity
    gained = mesh.area_cell * bernoulli * plain.thickness
    assert abs(work.sum() + gained.sum()) < 1e-13 * np.abs(gained).sum()
    assert abs(mesh.area_cell @ plain.thickness) < 1e-14 * (mesh.area_cell @ np.abs(plain.thickness))
    assert np.abs(plain.normal_velocity).max() > 1e-4
