"""Biharmonic dissipation: its operator on spherical harmonics, its symmetry, its bound, its effect."""

import warnings

import numpy as np
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.discrete.operators import normal_velocity_from_streamfunction
from swe import Simulation
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.model import ShallowWaterModel
from swe.errors import SetupWarning

RADIUS = 6.4e6


def model_on(mesh: VoronoiMesh) -> ShallowWaterModel:
    return ShallowWaterModel(mesh.scaled(RADIUS), np.zeros(mesh.n_cells), np.zeros(mesh.n_vertices), 9.8)


def test_laplacian_of_spherical_harmonics(larger_mesh: VoronoiMesh) -> None:
    """With the streamfunction or the potential (3 sin^2 - 1)/2, lap u = -6/a^2 u, in the mean."""
    model = model_on(larger_mesh)
    mesh, dissipation = model.mesh, BiharmonicDissipation(model.mesh, 1.0)
    measure, found = mesh.dv_edge * mesh.dc_edge, np.empty(mesh.n_edges)
    potential = 1.5 * np.sin(mesh.lat_cell) ** 2 - 0.5
    for velocity in (
        normal_velocity_from_streamfunction(mesh, 1.5 * np.sin(mesh.lat_vertex) ** 2 - 0.5),
        (potential[mesh.cells_on_edge[:, 1]] - potential[mesh.cells_on_edge[:, 0]]) / mesh.dc_edge,
    ):
        dissipation.laplacian(velocity, found)
        assert (measure * velocity) @ found == pytest.approx(
            -6.0 / RADIUS**2 * (measure @ velocity**2), rel=0.01, abs=0.0
        )


def test_the_operator_is_symmetric_and_takes_energy(any_mesh: VoronoiMesh) -> None:
    model, random = model_on(any_mesh), np.random.default_rng(3)
    dissipation = BiharmonicDissipation(model.mesh, 1e12)
    measure = model.mesh.dv_edge * model.mesh.dc_edge
    u, v = random.normal(size=(2, any_mesh.n_edges))
    on_u, on_v = dissipation.acceleration(u).copy(), dissipation.acceleration(v).copy()
    if any_mesh.dv_edge.min() < 1e-3:
        pytest.skip("edges of no length make it infinite")
    assert (measure * u) @ on_v == pytest.approx((measure * v) @ on_u, rel=1e-9)
    assert (measure * u) @ on_u < 0.0


def test_the_bound_of_the_time_step_is_close(icosahedral_mesh: VoronoiMesh) -> None:
    dissipation = BiharmonicDissipation(model_on(icosahedral_mesh).mesh, 1e15)
    vector = np.random.default_rng(0).normal(size=icosahedral_mesh.n_edges)
    for _ in range(200):
        vector = dissipation.acceleration(vector / np.linalg.norm(vector)).copy()
    limit = 2.0 / np.linalg.norm(vector)
    assert 0.5 * limit < dissipation.largest_time_step <= limit


def test_dissipation_smooths_a_run(larger_mesh: VoronoiMesh) -> None:
    plain, smooth = (Simulation(larger_mesh, Williamson5(), dissipation=value) for value in (0.0, 1e16))
    for simulation in (plain, smooth):
        simulation.run(days=2, progress=False)
    assert smooth.invariants.total_energy < plain.invariants.total_energy
    assert smooth.invariants.potential_enstrophy < plain.invariants.potential_enstrophy
    assert smooth.invariants.mass == pytest.approx(plain.invariants.mass, rel=1e-15)


def test_an_unstable_step_is_warned_of(icosahedral_mesh: VoronoiMesh) -> None:
    with pytest.warns(
        SetupWarning, match=r"a time step of 5000 s is likely to be unstable, as the Courant .*; one of .* s would do"
    ):
        Simulation(icosahedral_mesh, Williamson5(), time_step=5000.0)
    with pytest.warns(SetupWarning, match="a time step of 600 s .* as it is long for the dissipation") as caught:
        Simulation(icosahedral_mesh, Williamson5(), time_step=600.0, dissipation=1e19)
    limit = float(str(caught[0].message).split("one of ")[1].split(" s")[0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Simulation(icosahedral_mesh, Williamson5(), time_step=limit, dissipation=1e19)
