"""A change of any value of a validated mesh is noticed."""

from dataclasses import fields

import numpy as np
import pytest

from mesh import VoronoiMesh, mesh_from_points
from mesh.generation.generators import icosahedral_points
from mesh.validated import is_validated, remember_validated

ARRAYS = [
    each.name
    for each in fields(VoronoiMesh)
    if each.name.startswith(("x_c", "x_e", "x_v", "n_", "cells_", "area", "boundary"))
]


@pytest.fixture
def mesh() -> VoronoiMesh:
    return mesh_from_points(icosahedral_points(1))


@pytest.mark.parametrize("name", ARRAYS)
def test_one_value(mesh: VoronoiMesh, name: str) -> None:
    values = getattr(mesh, name).reshape(-1)
    for place in (0, len(values) // 2, -1):
        assert is_validated(mesh)
        before = values[place]
        values[place] += 1
        assert not is_validated(mesh)
        values[place] = before
    assert is_validated(mesh)


def test_signs_and_order(mesh: VoronoiMesh) -> None:
    """Of values 4 apart, which are summed in one lane."""
    for places in ([0, 4], [1, 5, 9, 13], [0, 1]):
        mesh.x_edge[places] *= -1.0
        assert not is_validated(mesh)
        mesh.x_edge[places] *= -1.0
        mesh.x_edge[places] = mesh.x_edge[places[::-1]]
        assert not is_validated(mesh)
        mesh.x_edge[places] = mesh.x_edge[places[::-1]]
        assert is_validated(mesh)


def test_meshes_are_known_by_themselves(mesh: VoronoiMesh) -> None:
    other = VoronoiMesh(**{each.name: getattr(mesh, each.name) for each in fields(mesh)})
    assert not is_validated(other)
    remember_validated(other)
    assert is_validated(other)
    np.testing.assert_array_equal(other.x_cell, mesh.x_cell)
