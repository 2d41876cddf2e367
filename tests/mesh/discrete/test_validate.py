"""Every kind of damage to a valid mesh is refused, by a sentence that names what is wrong."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from mesh import MeshError, VoronoiMesh, mesh_from_points, validate_mesh
from mesh.discrete.validate import OWN_TOLERANCE
from mesh.errors import HemisphereError


def test_own_meshes_hold_all_identities(any_mesh: VoronoiMesh) -> None:
    residuals = validate_mesh(any_mesh)
    assert len(residuals) == 8
    assert max(residuals.values()) <= OWN_TOLERANCE


@settings(deadline=None, max_examples=25)
@given(cells=st.integers(12, 400), seed=st.integers(0, 10**6))
def test_random_generators_give_valid_meshes(cells: int, seed: int) -> None:
    try:
        mesh = mesh_from_points(np.random.default_rng(seed).normal(size=(cells, 3)))
    except HemisphereError:
        reject()  # of 12 points one set in thirty lies in a hemisphere
    assert max(validate_mesh(mesh).values()) <= OWN_TOLERANCE


def changed(mesh: VoronoiMesh, name: str, change: Callable[[np.ndarray], object]) -> VoronoiMesh:
    array = getattr(mesh, name).copy()
    change(array)
    return replace(mesh, **{name: array})


def swap_columns(row: int, a: int, b: int) -> Callable[[np.ndarray], None]:
    def change(array: np.ndarray) -> None:
        array[row, a], array[row, b] = array[row, b], array[row, a].copy()

    return change


def assign(index: object, value: float) -> Callable[[np.ndarray], None]:
    return lambda array: array.__setitem__(index, value)


def scale(index: object, factor: float) -> Callable[[np.ndarray], None]:
    return lambda array: array.__setitem__(index, array[index] * factor)


DAMAGE = [
    ("cells_on_edge", swap_columns(17, 0, 1), "nEdgesOnEdge|edgesOnEdge|verticesOnEdge"),
    ("vertices_on_edge", swap_columns(17, 0, 1), "edges 17 .*verticesOnEdge does not run along"),
    ("cells_on_vertex", swap_columns(5, 0, 1), "vertices 5 .*cellsOnVertex"),
    ("edges_on_vertex", swap_columns(5, 0, 1), "vertices 5 .*edgesOnVertex"),
    ("edges_on_cell", swap_columns(100, 0, 1), "cells 100 .*(cellsOnCell|edgesOnCell)"),
    ("cells_on_cell", swap_columns(100, 0, 1), "cells 100 .*: cellsOnCell is not the cell across edgesOnCell$"),
    ("vertices_on_cell", swap_columns(100, 0, 1), "cells 100 .*verticesOnCell"),
    ("edges_on_edge", swap_columns(9, 2, 3), "edges 9 .*edgesOnEdge"),
    ("edges_on_edge", assign((9, 2), 10**6), "edges 9 .*edgesOnEdge holds an index outside"),
    ("cells_on_edge", assign((9, 0), -5), "edges 9 .*|nEdgesOnEdge"),
    ("n_edges_on_cell", assign(30, 2), "cells 30 .*nEdgesOnCell is not between"),
    ("n_edges_on_cell", assign(30, 5), "nEdgesOnEdge is not"),
    ("n_edges_on_edge", assign(30, 5), "edges 30 .*nEdgesOnEdge"),
    ("boundary_vertex", assign(4, 1), "vertices 4 .*boundaryVertex"),
    ("x_cell", assign(12, np.nan), "cells 12 .*xCell is not a finite number"),
    ("weights_on_edge", assign((3, 1), np.inf), "edges 3 .*weightsOnEdge is not a finite number"),
    ("z_cell", scale(12, 1.01), "cells 12 .*not at sphere_radius"),
    ("x_edge", scale(12, 1.0 + 1e-4), "edges 12 "),
    ("lat_vertex", scale(12, 1.0 + 1e-4), "vertices 12 .*latVertex"),
    ("lon_cell", scale(12, 1.0 + 1e-4), "cells 12 .*lonCell"),
    ("dc_edge", scale(12, -1.0), "edges 12 .*dcEdge"),
    ("dv_edge", scale(12, 1.0 + 1e-5), "edges 12 .*dvEdge"),
    ("area_cell", scale(12, 1.0 + 1e-5), "cells 12 .*areaCell"),
    ("area_triangle", scale(12, 1.0 + 1e-5), "vertices 12 .*areaTriangle"),
    ("kite_areas_on_vertex", scale((12, 1), 1.0 + 1e-4), "vertices 12 .*kiteAreasOnVertex"),
    ("weights_on_edge", scale((12, 1), -1.0), "edges 12 .*weightsOnEdge"),
    ("angle_edge", assign(12, 0.123), "edges 12 .*angleEdge"),
]


@pytest.mark.parametrize(("name", "change", "words"), DAMAGE, ids=[f"{k}-{row[0]}" for k, row in enumerate(DAMAGE)])
def test_damage_is_refused(
    icosahedral_mesh: VoronoiMesh, name: str, change: Callable[[np.ndarray], object], words: str
) -> None:
    damaged = changed(icosahedral_mesh, name, change)
    with pytest.raises(MeshError, match=words):
        validate_mesh(damaged, tolerance=1e-6)


def test_noise_above_the_tolerance_of_identities_is_refused(icosahedral_mesh: VoronoiMesh) -> None:
    noise = 1 + 1e-8 * np.random.default_rng(0).normal(size=icosahedral_mesh.weights_on_edge.shape)
    noisy = replace(icosahedral_mesh, weights_on_edge=icosahedral_mesh.weights_on_edge * noise)
    assert 1e-10 < validate_mesh(noisy, tolerance=1e-6)["antisymmetry of weightsOnEdge"] < 1e-6
    with pytest.raises(MeshError, match="antisymmetry of weightsOnEdge holds only to"):
        validate_mesh(noisy)


def test_wrong_counts_are_refused(icosahedral_mesh: VoronoiMesh) -> None:
    with pytest.raises(MeshError, match=r"areaCell has shape \(641,\) instead of \(642,\)"):
        validate_mesh(replace(icosahedral_mesh, area_cell=icosahedral_mesh.area_cell[:-1]))


def test_mirrored_mesh_is_refused(icosahedral_mesh: VoronoiMesh) -> None:
    flipped = {f"z_{place}": -getattr(icosahedral_mesh, f"z_{place}") for place in ("cell", "edge", "vertex")}
    with pytest.raises(
        MeshError,
        match=r"vertices 0, 1, 2 and 1277 more \(.*\): cellsOnVertex does not run counter-clockwise",
    ):
        validate_mesh(replace(icosahedral_mesh, **flipped))
