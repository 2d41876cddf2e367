"""Each identity of the discrete calculus notices a mesh in which one entry is wrong, and says what matrices say."""

from dataclasses import replace

import numpy as np
import pytest

from mesh import VoronoiMesh, build_operators
from mesh.discrete.identities import (
    _adjoint_defect,
    _circulations,
    _curl_of_gradient,
    _gradient,
    _outflows,
    _perp_inconsistency,
    _tangential,
)


def test_two_weights_in_the_wrong_place_are_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    """Their sum stays as it is, so that only a flux that varies tells them apart."""
    assert _perp_inconsistency(icosahedral_mesh) < 1e-12
    weights = icosahedral_mesh.weights_on_edge.copy()
    weights[17, [0, 1]] = weights[17, [1, 0]]
    assert _perp_inconsistency(replace(icosahedral_mesh, weights_on_edge=weights)) > 1e-3


def test_a_wrong_kite_is_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    kites = icosahedral_mesh.kite_areas_on_vertex.copy()
    kites[5, 1] *= 1.2
    assert _perp_inconsistency(replace(icosahedral_mesh, kite_areas_on_vertex=kites)) > 1e-3


def test_a_wrong_side_of_a_triangle_is_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    assert _curl_of_gradient(icosahedral_mesh) < 1e-12
    ends = icosahedral_mesh.vertices_on_edge.copy()
    ends[5] = ends[5, ::-1]
    assert _curl_of_gradient(replace(icosahedral_mesh, vertices_on_edge=ends)) > 1e-3


def test_a_wrong_side_of_a_cell_is_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    assert _adjoint_defect(icosahedral_mesh) < 1e-12
    edges = icosahedral_mesh.edges_on_cell.copy()
    edges[5, 0] = edges[6, 3]
    assert _adjoint_defect(replace(icosahedral_mesh, edges_on_cell=edges)) > 1e-6


@pytest.mark.parametrize("radius", [1.0, 6371220.0])
def test_loops_are_the_operators(icosahedral_mesh: VoronoiMesh, radius: float) -> None:
    mesh = icosahedral_mesh.scaled(radius)
    operators, generator = build_operators(mesh), np.random.default_rng(3)
    flux, field = generator.normal(size=mesh.n_edges), generator.normal(size=mesh.n_cells)
    rows = mesh.n_edges_on_edge, mesh.edges_on_edge, mesh.weights_on_edge
    for loop, matrix in (
        (_tangential(flux, *rows), operators.perp @ flux),
        (_gradient(mesh, field), operators.gradient @ field),
        (_outflows(mesh, flux) / mesh.area_cell, operators.divergence @ flux),
        (_circulations(mesh, flux) / mesh.area_triangle, operators.curl @ flux),
    ):
        np.testing.assert_allclose(loop, matrix, rtol=0, atol=1e-13 * np.abs(matrix).max())
