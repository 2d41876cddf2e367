"""Thickness at vertices of obtuse meshes: told of before a run, and named where it is what goes wrong."""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from cases import LakeAtRest, Williamson5
from mesh import VoronoiMesh, build_operators, mesh_from_points
from mesh.arrays import Array
from swe import RunError, Simulation
from swe.equations.soundness import (
    has_negative_kites,
    problem_at_vertices,
    thin_vertices,
    vertex_thickness,
    warning_of_vertices,
)
from swe.errors import InputError, SetupWarning


@dataclass(frozen=True)
class Rough(LakeAtRest):
    """Thickness between `least` and `most` that changes from cell to cell."""

    name: ClassVar[str] = "rough"
    least: float = 50.0
    most: float = 5000.0

    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        share = np.random.default_rng(3).uniform(size=longitude.shape)
        return self.least + share * (self.most - self.least)


@pytest.fixture(scope="module")
def obtuse_mesh() -> VoronoiMesh:
    return mesh_from_points(np.random.default_rng(1).normal(size=(500, 3)))


def test_vertex_thickness_is_that_of_the_operators(obtuse_mesh: VoronoiMesh, icosahedral_mesh: VoronoiMesh) -> None:
    for mesh in (obtuse_mesh, icosahedral_mesh):
        h = np.random.default_rng(1).uniform(1.0, 2.0, mesh.n_cells)
        np.testing.assert_allclose(vertex_thickness(mesh, h), build_operators(mesh).cell_to_vertex @ h, rtol=1e-12)
    assert has_negative_kites(obtuse_mesh)
    assert not has_negative_kites(icosahedral_mesh)


def test_thickness_that_is_negative_at_a_vertex_is_refused(obtuse_mesh: VoronoiMesh) -> None:
    words = (
        r"^the initial thickness is -\d.* m at vertex \d+ \(counted from 0\) at longitude .* degrees, the corner of "
        r"cells of .* m: \d+ triangles of the mesh are so obtuse that kites are negative; use a mesh without them"
    )
    with pytest.raises(InputError, match=words):
        Simulation(obtuse_mesh, Rough())


def test_thickness_that_is_thin_at_a_vertex_is_told_of(obtuse_mesh: VoronoiMesh) -> None:
    h = np.full(obtuse_mesh.n_cells, 1000.0)
    assert problem_at_vertices(obtuse_mesh, h) is None
    assert thin_vertices(obtuse_mesh, h) == 0
    vertex = int(np.argmin(obtuse_mesh.kite_areas_on_vertex.min(axis=1) / obtuse_mesh.area_triangle))
    corner = int(np.argmin(obtuse_mesh.kite_areas_on_vertex[vertex]))
    share = -obtuse_mesh.kite_areas_on_vertex[vertex, corner] / obtuse_mesh.area_triangle[vertex]
    cell = obtuse_mesh.cells_on_vertex[vertex, corner]
    h[cell] = 1000.0 * (1.0 + 0.9 / share)
    assert vertex_thickness(obtuse_mesh, h)[vertex] == pytest.approx(100.0)
    assert problem_at_vertices(obtuse_mesh, h) is None
    assert thin_vertices(obtuse_mesh, h) == 1
    assert "at 1 vertex of obtuse triangles thickness is less than 0.5 of that of the" in warning_of_vertices(1)
    h[cell] = 1000.0 * (1.0 + 1.1 / share)
    assert f"thickness is -100 m at vertex {vertex} (counted from 0)" in str(problem_at_vertices(obtuse_mesh, h))
    h[0] = -1.0
    assert problem_at_vertices(obtuse_mesh, h) is None, "that is a matter of the cells"


def test_a_warning_before_and_the_right_words_after(obtuse_mesh: VoronoiMesh, tmp_path: Path) -> None:
    with pytest.warns(SetupWarning, match="vertices of obtuse triangles thickness is less than 0.5"):
        simulation = Simulation(obtuse_mesh, Rough(least=3700.0), tmp_path)
    with pytest.raises(RunError, match=r"the thickness is -?\d.* m at vertex \d+ .*kites are negative"):
        simulation.run(20.0, progress=False)
    with pytest.raises(InputError, match="the run broke off and cannot go on; make the simulation again, with resume"):
        simulation.run(20.0, progress=False)


def test_an_acute_mesh_is_not_warned_of(icosahedral_mesh: VoronoiMesh) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Simulation(icosahedral_mesh, Williamson5())


def test_without_a_directory_there_is_nothing_to_resume(icosahedral_mesh: VoronoiMesh) -> None:
    with pytest.warns(SetupWarning, match="likely to be unstable"):
        simulation = Simulation(icosahedral_mesh, Williamson5(), time_step=9000.0)
    with pytest.raises(RunError):
        simulation.run(5.0, progress=False)
    with pytest.raises(InputError, match=r"^the run broke off and cannot go on; make the simulation again$"):
        simulation.run(5.0, progress=False)
