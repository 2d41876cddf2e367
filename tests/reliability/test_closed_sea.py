"""Rest and free turbulence in a closed sea with islands, with both schemes and any slip along the coasts."""

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.coast.generation import region_mesh
from mesh.discrete.walls import wall_edges
from mesh.mesh_request import MeshRequest
from mesh.regions.find import find_region
from tests.cut_mesh import random_sea
from tests.reliability.closed_sea import IN_REAL_SEAS, OPTIONS, REAL_SEA_EDDIES, speed_at_rest, turbulence


@pytest.fixture(scope="module")
def sea(larger_mesh: VoronoiMesh) -> VoronoiMesh:
    found = random_sea(larger_mesh)
    assert len(wall_edges(found)) > 300
    return found


@pytest.mark.parametrize("scheme", ["ringler2010", "consistent"])
@pytest.mark.parametrize("integrator", ["rk4", "fbrk3"])
def test_a_lake_of_random_depth_stays_at_rest(sea: VoronoiMesh, scheme: str, integrator: str) -> None:
    if scheme == "consistent" and integrator == "fbrk3":
        pytest.skip("plain loops are slow")
    assert 0.0 < speed_at_rest(sea, 10.0, scheme=scheme, integrator=integrator) < 1e-11


@pytest.mark.parametrize(
    ("options", "days"),
    [
        pytest.param(options, days, marks=[pytest.mark.slow] * ((options, days) != (next(iter(OPTIONS)), 4.0)))
        for options in OPTIONS
        for days in (4.0, 50.0)
    ],
)
def test_free_turbulence_keeps_mass_and_energy(sea: VoronoiMesh, options: str, days: float) -> None:
    simulation, worst = turbulence(sea, days, **OPTIONS[options])
    assert worst["mass"] < 1e-14
    assert worst["total_energy"] < 1e-14
    assert not simulation.state.normal_velocity[wall_edges(sea)].any()
    assert np.abs(simulation.state.normal_velocity).max() > 5.0
    assert simulation.loops == "fused"


@pytest.mark.slow
@pytest.mark.parametrize("options", IN_REAL_SEAS)
@pytest.mark.parametrize("region", ["world-ocean", "north-atlantic"])
def test_real_seas_keep_rest_mass_and_energy(region: str, options: str) -> None:
    sea = region_mesh(find_region(region), MeshRequest(cells=2562, tolerance=1e-4))
    assert 0.0 < speed_at_rest(sea, 10.0, **OPTIONS[options]) < 1e-11
    simulation, worst = turbulence(sea, 5.0, REAL_SEA_EDDIES, **OPTIONS[options])
    assert worst["mass"] < 1e-14
    assert worst["total_energy"] < 1e-14
    assert np.abs(simulation.state.normal_velocity).max() > 5.0
