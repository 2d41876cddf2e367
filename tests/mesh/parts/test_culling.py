"""Culled meshes: the conventions of the community's culler, and signs that fit edges whose normals are turned."""

from dataclasses import fields
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from numpy.typing import NDArray

from mesh import MeshError, VoronoiMesh, write_mesh
from mesh.discrete.walls import wall_edges
from mesh.geometry.angles import about_zero
from mesh.parts.culling import culled
from mesh.parts.cutting import without_cells
from tests.plain_culler import culled_arrays

UNLIKE_THE_TOOLS = {"boundaryVertex", "angleEdge", "nEdgesOnEdge", "edgesOnEdge", "weightsOnEdge"}
"""Arrays that the community's tools do not write, or leave as they were before edges were turned."""


@pytest.fixture
def kept(any_mesh: VoronoiMesh) -> NDArray[np.bool_]:
    """A sea with an island of one cell."""
    kept = any_mesh.lat_cell < 0.6
    kept[np.argmin(any_mesh.lat_cell)] = False
    return kept


def test_arrays_are_those_of_the_communitys_rules(
    any_mesh: VoronoiMesh, kept: NDArray[np.bool_], tmp_path: Path
) -> None:
    def arrays_of(mesh: VoronoiMesh) -> dict[str, NDArray]:
        write_mesh(mesh, tmp_path / "mesh.nc")
        with netCDF4.Dataset(tmp_path / "mesh.nc") as file:
            file.set_auto_mask(False)
            return {name: file[name][:] for name in file.variables}

    expected, _ = culled_arrays(arrays_of(any_mesh), kept)
    found = arrays_of(culled(any_mesh, kept))
    for name in expected.keys() - UNLIKE_THE_TOOLS:
        np.testing.assert_array_equal(found[name], expected[name], err_msg=name)
    np.testing.assert_array_equal(found["boundaryVertex"], (found["cellsOnVertex"] == 0).any(axis=1))


def test_a_wall_has_its_cell_first_and_its_tangent_counter_clockwise_round_it(
    any_mesh: VoronoiMesh, kept: NDArray[np.bool_]
) -> None:
    sea = culled(any_mesh, kept)
    walls = wall_edges(sea)
    assert np.all(sea.cells_on_edge[walls, 0] >= 0)
    assert np.all(sea.cells_on_edge[walls, 1] == -1)
    for wall in walls:
        cell = sea.cells_on_edge[wall, 0]
        place = int(np.flatnonzero(sea.edges_on_cell[cell] == wall)[0])
        ring = sea.vertices_on_cell[cell, : sea.n_edges_on_cell[cell]]
        assert sea.vertices_on_edge[wall].tolist() == [ring[place - 1], ring[place]]


def test_angles_and_weights_follow_the_edges_that_turn(any_mesh: VoronoiMesh, kept: NDArray[np.bool_]) -> None:
    part, sea = without_cells(any_mesh, ~kept), culled(any_mesh, kept)
    turned = part.cells_on_edge[:, 0] < 0
    assert 0 < turned.sum() < len(wall_edges(part))
    difference = np.abs(about_zero(sea.angle_edge - part.angle_edge))
    np.testing.assert_allclose(difference, np.where(turned, np.pi, 0.0), atol=1e-14)
    # One flow, told by the normals of either mesh, has one tangential velocity, told by the tangents of either.
    sign = np.where(turned, -1.0, 1.0)
    flow = np.random.default_rng(3).uniform(-1.0, 1.0, part.n_edges)
    np.testing.assert_allclose(tangential(sea, sign * flow), sign * tangential(part, flow), rtol=0.0, atol=1e-15)
    inner = sea.cells_on_edge[:, 1] >= 0
    between_inner = inner[:, None] & inner[sea.edges_on_edge] & (sea.edges_on_edge >= 0)
    np.testing.assert_array_equal(sea.weights_on_edge[between_inner], part.weights_on_edge[between_inner])


def tangential(mesh: VoronoiMesh, flow: NDArray) -> NDArray:
    return (mesh.weights_on_edge * np.where(mesh.edges_on_edge >= 0, flow[mesh.edges_on_edge], 0.0)).sum(axis=1)


def test_culling_twice_is_culling_once(any_mesh: VoronoiMesh, kept: NDArray[np.bool_]) -> None:
    first = any_mesh.lat_cell < 0.6
    twice, once = culled(culled(any_mesh, first), kept[first]), culled(any_mesh, kept)
    for field in fields(VoronoiMesh):
        if isinstance(getattr(once, field.name), np.ndarray):
            np.testing.assert_array_equal(getattr(twice, field.name), getattr(once, field.name), err_msg=field.name)


def test_all_cells_kept_is_the_mesh_itself(any_mesh: VoronoiMesh) -> None:
    whole = culled(any_mesh, np.ones(any_mesh.n_cells, np.bool_))
    for field in fields(VoronoiMesh):
        if isinstance(getattr(whole, field.name), np.ndarray):
            np.testing.assert_array_equal(getattr(whole, field.name), getattr(any_mesh, field.name))


def test_one_cell_alone_is_a_mesh(any_mesh: VoronoiMesh) -> None:
    lake = culled(any_mesh, np.arange(any_mesh.n_cells) == 5)
    n = int(any_mesh.n_edges_on_cell[5])
    assert (lake.n_cells, lake.n_edges, lake.n_vertices) == (1, n, n)
    assert lake.area_triangle.sum() == pytest.approx(any_mesh.area_cell[5], rel=1e-13)


def test_marks_that_keep_nothing_or_do_not_fit_are_refused(any_mesh: VoronoiMesh) -> None:
    with pytest.raises(MeshError, match=f"^none of the {any_mesh.n_cells} cells is kept; choose"):
        culled(any_mesh, np.zeros(any_mesh.n_cells, np.bool_))
    with pytest.raises(MeshError, match=r"have shape \(3,\), but the mesh needs"):
        culled(any_mesh, np.ones(3, np.bool_))
