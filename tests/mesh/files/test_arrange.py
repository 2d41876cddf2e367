"""Arrays that hold other entities than the triangles and edges of a file give."""

import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh
from mesh.files.arrange import arranged_topology


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("cells_on_cell", r"cells \d.*: cellsOnCell has room for 5 entries and needs more$"),
        ("edges_on_cell", r"cells \d.*: edgesOnCell has room for 5 entries and needs more$"),
        ("edges_on_edge", r"edges \d.*: edgesOnEdge has room for 5 entries and needs more$"),
    ],
)
def test_rings_without_room_are_refused(small_mesh: VoronoiMesh, name: str, words: str) -> None:
    arrays = {each: getattr(small_mesh, each) for each in ("cells_on_vertex", "cells_on_edge")}
    arrays[name] = getattr(small_mesh, name)[:, :5]
    with pytest.raises(MeshError, match=words):
        arranged_topology(arrays, small_mesh.cell_points)


def test_rings_with_room_to_spare_are_taken(small_mesh: VoronoiMesh) -> None:
    arrays = {each: getattr(small_mesh, each) for each in ("cells_on_vertex", "cells_on_edge")}
    arrays["cells_on_cell"] = np.pad(small_mesh.cells_on_cell, ((0, 0), (0, 3)), constant_values=-1)
    topology = arranged_topology(arrays, small_mesh.cell_points)
    np.testing.assert_array_equal(np.sort(topology.cells_on_cell[:, :5]), np.sort(small_mesh.cells_on_cell[:, :5]))
