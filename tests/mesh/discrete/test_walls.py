"""Parts of spheres: nothing flows through the cut, and the identities of the discrete calculus hold on what is left."""

from dataclasses import replace

import numpy as np
import pytest

from mesh import VoronoiMesh, build_operators
from mesh.discrete.operators import normal_component, velocity_at_cells
from mesh.discrete.walls import closed_mesh, wall_edges
from mesh.geometry.sphere import east_north
from tests.cut_mesh import without_cap


@pytest.fixture
def part(any_mesh: VoronoiMesh) -> VoronoiMesh:
    return without_cap(any_mesh)


def test_a_part_has_walls_and_a_sphere_has_none(any_mesh: VoronoiMesh, part: VoronoiMesh) -> None:
    assert len(wall_edges(any_mesh)) == 0
    assert closed_mesh(any_mesh) is any_mesh
    walls = wall_edges(part)
    assert 0 < len(walls) < part.n_edges // 2
    # A wall is beside one cell, and each cell knows it.
    assert np.count_nonzero((part.cells_on_cell < 0) & part.on_ring) == len(walls)
    assert np.all((part.cells_on_edge[walls] >= 0).sum(axis=1) == 1)


def test_signs_of_edges_vanish_at_walls(part: VoronoiMesh) -> None:
    signs, around = part.edge_signs_on_cell, part.edge_signs_on_vertex
    is_wall = np.isin(part.edges_on_cell, wall_edges(part)) & part.on_ring
    assert np.all(signs[is_wall] == 0)
    assert np.all(np.abs(signs[part.on_ring & ~is_wall]) == 1)
    np.testing.assert_array_equal(around == 0, part.edges_on_vertex < 0)
    # Through each edge as much leaves one cell as enters the other; round each goes one vertex to the left of it.
    summed = np.bincount(part.edges_on_cell[part.on_ring], signs[part.on_ring], part.n_edges)
    assert np.all(summed == 0)
    there = part.edges_on_vertex >= 0
    assert np.all(np.bincount(part.edges_on_vertex[there], around[there], part.n_edges) == 0)


def test_no_index_of_a_closed_mesh_is_missing(part: VoronoiMesh) -> None:
    closed = closed_mesh(part)
    for name in ("cells_on_edge", "cells_on_vertex", "edges_on_vertex"):
        assert getattr(part, name).min() == -1, name
        assert getattr(closed, name).min() >= 0, name
        present = getattr(part, name) >= 0
        np.testing.assert_array_equal(getattr(closed, name)[present], getattr(part, name)[present])


def test_a_mesh_is_closed_once(part: VoronoiMesh, any_mesh: VoronoiMesh) -> None:
    """All who ask share one, which other meshes do not get; a whole mesh is its own."""
    closed = closed_mesh(part)
    assert closed_mesh(part) is closed
    assert closed_mesh(replace(part)) is not closed
    assert closed_mesh(any_mesh) is any_mesh


def test_kites_of_missing_cells_have_no_area(part: VoronoiMesh) -> None:
    """Whatever a mesh says of them."""
    filled = replace(part, kite_areas_on_vertex=part.kite_areas_on_vertex + 1.0)
    kites = closed_mesh(filled).kite_areas_on_vertex
    missing = part.cells_on_vertex < 0
    assert np.all(kites[missing] == 0.0)
    np.testing.assert_array_equal(kites[~missing], filled.kite_areas_on_vertex[~missing])


def test_operators_of_a_part(part: VoronoiMesh) -> None:
    """Divergence and gradient are adjoint and know no walls; weights are antisymmetric; constants have no gradient."""
    operators, random, walls = build_operators(part), np.random.default_rng(4), wall_edges(part)
    measure = part.dv_edge * part.dc_edge
    h, u, v = random.normal(size=part.n_cells), random.normal(size=part.n_edges), random.normal(size=part.n_edges)
    gradient, divergence = operators.gradient @ h, operators.divergence @ u
    size = np.abs(measure * gradient) @ np.abs(u)
    assert abs(measure @ (gradient * u) + part.area_cell @ (h * divergence)) < 1e-14 * size
    assert np.all(gradient[walls] == 0.0)
    assert abs(part.area_cell @ divergence) < 1e-14 * (part.dv_edge @ np.abs(u))
    # Flow through walls, were there any, would change nothing.
    through = np.zeros(part.n_edges)
    through[walls] = 1.0
    assert not (operators.divergence @ through).any()
    assert not (operators.perp @ through).any()
    assert not (operators.perp @ u)[walls].any()
    weighted = part.dv_edge * part.dc_edge * (operators.perp @ (v / part.dv_edge))
    other = part.dv_edge * part.dc_edge * (operators.perp @ (u / part.dv_edge))
    if part.dv_edge.min() > 1e-6:
        work, back = (u / part.dv_edge) @ weighted, (v / part.dv_edge) @ other
        assert abs(work + back) < 1e-12 * np.abs(u / part.dv_edge) @ np.abs(weighted)
    np.testing.assert_allclose(operators.cell_to_vertex @ np.ones(part.n_cells), 1.0, rtol=1e-14)
    np.testing.assert_allclose(operators.cell_to_edge @ np.ones(part.n_cells), 1.0, rtol=1e-15)
    kinetic = part.area_cell @ (operators.kinetic_energy @ u**2)
    share = np.where(np.isin(np.arange(part.n_edges), walls), 0.25, 0.5) * measure
    assert kinetic == pytest.approx(share @ u**2, rel=1e-13)


def test_velocity_beside_walls(icosahedral_mesh: VoronoiMesh) -> None:
    """A vector in the plane of each cell is found again from its normal components, with those at walls."""
    part = without_cap(icosahedral_mesh)
    axis = np.array([0.3, -0.5, 0.8])
    east, north = east_north(part.lon_edge, part.lat_edge)
    rotating = np.cross(axis, part.edge_points)
    normal = normal_component(part, (rotating * east).sum(axis=1), (rotating * north).sum(axis=1))
    zonal, meridional = velocity_at_cells(part, normal)
    east, north = east_north(part.lon_cell, part.lat_cell)
    rotating = np.cross(axis, part.cell_points)
    np.testing.assert_allclose(zonal, (rotating * east).sum(axis=1), atol=0.01)
    np.testing.assert_allclose(meridional, (rotating * north).sum(axis=1), atol=0.01)
