"""Parts of a mesh: every entity has one owner, own entities have their surroundings, and order stays."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mesh import VoronoiMesh
from mesh.arrays import Index
from mesh.errors import MeshError
from mesh.parts.cutting import without_cells
from mesh.parts.mesh_part import MeshPart, cut_part
from tests.cut_mesh import without_cap

BLOCKS = 3


@pytest.fixture(params=["sphere", "coast"])
def mesh(request: pytest.FixtureRequest, any_mesh: VoronoiMesh) -> VoronoiMesh:
    if request.param == "sphere":
        return any_mesh
    if any_mesh.n_cells < 100:
        pytest.skip("no cap of a few cells")
    return without_cap(any_mesh)


def blocks_of(mesh: VoronoiMesh) -> Index:
    return (mesh.lon_cell / (2.0 * np.pi) * BLOCKS).astype(int) % BLOCKS


def parts_of(mesh: VoronoiMesh, rings: int = 2) -> list[MeshPart]:
    return [cut_part(mesh, blocks_of(mesh), block, rings) for block in range(BLOCKS)]


def test_every_entity_has_one_owner(mesh: VoronoiMesh) -> None:
    parts = parts_of(mesh)
    for place in ("cells", "edges", "vertices"):
        own = [getattr(part, place)[getattr(part, f"own_{place}")] for part in parts]
        np.testing.assert_array_equal(np.sort(np.concatenate(own)), np.arange(getattr(mesh, f"n_{place}")))
    for part in parts:
        for place in ("cells", "edges", "vertices"):
            assert (np.diff(getattr(part, place)) > 0).all()


def test_own_entities_are_those_of_the_whole(mesh: VoronoiMesh) -> None:
    """With the same neighbours in the same order, and the same sizes."""
    for part in parts_of(mesh, rings=1):
        cells, edges, vertices = part.own_cells, part.own_edges, part.own_vertices
        for name, own, numbers, of in (
            ("edges_on_cell", cells, part.cells, part.edges),
            ("cells_on_cell", cells, part.cells, part.cells),
            ("vertices_on_cell", cells, part.cells, part.vertices),
            ("cells_on_edge", edges, part.edges, part.cells),
            ("edges_on_edge", edges, part.edges, part.edges),
            ("vertices_on_edge", edges, part.edges, part.vertices),
            ("cells_on_vertex", vertices, part.vertices, part.cells),
            ("edges_on_vertex", vertices, part.vertices, part.edges),
        ):
            found = np.append(of, -1)[getattr(part.mesh, name)[own]]
            np.testing.assert_array_equal(found, getattr(mesh, name)[numbers[own]], err_msg=name)
        for name, own, numbers in (
            ("n_edges_on_cell", cells, part.cells),
            ("area_cell", cells, part.cells),
            ("mesh_density", cells, part.cells),
            ("dc_edge", edges, part.edges),
            ("weights_on_edge", edges, part.edges),
            ("n_edges_on_edge", edges, part.edges),
            ("kite_areas_on_vertex", vertices, part.vertices),
            ("area_triangle", vertices, part.vertices),
            ("edge_signs_on_vertex", vertices, part.vertices),
            ("edge_signs_on_cell", cells, part.cells),
        ):
            np.testing.assert_array_equal(
                getattr(part.mesh, name)[own], getattr(mesh, name)[numbers[own]], err_msg=name
            )


def within(mesh: VoronoiMesh, marked: NDArray[np.bool_], rings: int) -> NDArray[np.bool_]:
    """The marked cells (n_cells,), and those that fewer than or as many as `rings` edges lie between."""
    for _ in range(rings):
        touched = marked[mesh.cells_on_edge].any(axis=1)
        marked = marked.copy()
        marked[mesh.cells_on_edge[touched]] = True
    return marked


def test_halo_is_as_wide_as_asked(icosahedral_mesh: VoronoiMesh) -> None:
    """Neighbours of own cells are there with one ring, theirs with two; edges of the halo lie between two cells."""
    mesh, blocks = icosahedral_mesh, blocks_of(icosahedral_mesh)
    for rings in (0, 1, 2):
        part = cut_part(mesh, blocks, 1, rings)
        np.testing.assert_array_equal(part.cells, np.flatnonzero(within(mesh, blocks == 1, rings)))
        own = part.mesh.cells_on_cell[part.own_cells][part.mesh.on_ring[part.own_cells]]
        assert (own >= 0).all() == (rings > 0)
        assert len(part.halo_cells) == part.mesh.n_cells - len(part.own_cells)
        assert (part.mesh.cells_on_edge[part.halo_edges] >= 0).all()
        assert not np.intersect1d(part.halo_edges, part.own_edges).size


def test_a_block_without_cells_is_refused(icosahedral_mesh: VoronoiMesh) -> None:
    with pytest.raises(MeshError, match="block 3 has no cells"):
        cut_part(icosahedral_mesh, blocks_of(icosahedral_mesh), 3, 2)
    with pytest.raises(MeshError, match=r"shape \(5,\)"):
        cut_part(icosahedral_mesh, np.zeros(5, int), 0, 2)


def test_missing_cells_of_the_whole_stay_missing(icosahedral_mesh: VoronoiMesh) -> None:
    """Cutting twice is cutting once."""
    first = icosahedral_mesh.lat_cell > 0.8
    both = first | (icosahedral_mesh.lon_cell < 1.0)
    once = without_cells(icosahedral_mesh, both)
    twice = without_cells(without_cells(icosahedral_mesh, first), both[~first])
    for name in ("cells_on_edge", "cells_on_vertex", "edges_on_vertex", "edges_on_edge", "n_edges_on_edge"):
        np.testing.assert_array_equal(getattr(twice, name), getattr(once, name), err_msg=name)
    np.testing.assert_array_equal(twice.weights_on_edge, once.weights_on_edge)
    np.testing.assert_allclose(twice.area_triangle, once.area_triangle, rtol=1e-14)
