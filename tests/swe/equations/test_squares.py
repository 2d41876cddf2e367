"""Lattices of squares: four generators on one circle make edges without length, through which nothing flows."""

import numpy as np
import pytest

from cases import Williamson2
from mesh import VoronoiMesh, mesh_from_points, read_mesh, write_mesh
from mesh.discrete.operators import normal_velocity_from_streamfunction, vanishing_edges
from mesh.geometry.sphere import from_lonlat
from swe import Simulation
from swe.errors import InputError
from swe.integrators import STEPPINGS


@pytest.fixture(scope="module")
def squares() -> VoronoiMesh:
    """Parallels and meridians every 30 degrees: trapezia, each of them on one circle."""
    longitude, latitude = np.meshgrid(np.radians(np.arange(0, 360, 30)), np.radians([-60, -30, 0, 30, 60]))
    poles = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    return mesh_from_points(np.vstack([from_lonlat(longitude.ravel(), latitude.ravel()), poles]))


def test_edges_without_length_are_found(squares: VoronoiMesh, icosahedral_mesh: VoronoiMesh, tmp_path) -> None:
    assert len(vanishing_edges(squares)) == 48
    assert squares.dv_edge[vanishing_edges(squares)].max() < 1e-9
    assert len(vanishing_edges(icosahedral_mesh)) == 0
    write_mesh(squares, tmp_path / "squares.nc")
    assert read_mesh(tmp_path / "squares.nc").n_cells == 62


def test_they_take_the_velocity_of_their_neighbours(squares: VoronoiMesh) -> None:
    """Solid rotation about an oblique axis: what the streamfunction gives, to the error of the other edges."""
    axis = np.array([0.48, -0.36, 0.8])
    velocity = normal_velocity_from_streamfunction(squares, -squares.vertex_points @ axis)
    centers = squares.cell_points[squares.cells_on_edge]
    normal = centers[:, 1] - centers[:, 0]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    exact = (np.cross(axis, squares.edge_points) * normal).sum(axis=1)
    none = vanishing_edges(squares)
    assert np.abs(velocity - exact)[none].max() < 0.1
    assert np.abs(exact[none]).max() > 0.5


@pytest.mark.parametrize("integrator", STEPPINGS)
def test_a_case_runs_on_them(squares: VoronoiMesh, integrator: str) -> None:
    simulation = Simulation(squares, Williamson2(), integrator=integrator)
    before, start = simulation.state.copy(), simulation.initial_invariants
    simulation.run(1.0, progress=False)
    assert simulation.invariants.mass == pytest.approx(start.mass, rel=1e-15)
    assert simulation.invariants.total_energy == pytest.approx(
        start.total_energy, rel=1e-4 if integrator == "fbrk3" else 1e-5
    )
    assert np.abs(simulation.state.thickness - before.thickness).max() < 0.1 * before.thickness.max()


@pytest.mark.parametrize("option", [{"anticipation": 0.5}, {"dissipation": 1e15}])
def test_what_divides_by_their_length_is_refused(squares: VoronoiMesh, option: dict[str, float]) -> None:
    words = r"^edges of the mesh have no length \(48, the first of them 3, counted from 0\), as four generators lie on"
    with pytest.raises(InputError, match=words):
        Simulation(squares, Williamson2(), **option)
