import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.discrete.walls import has_walls
from mesh.geometry.sphere import normalize
from mesh.parts.culling import culled
from postprocess.figures.patches import Patches, cell_patches, edge_patches, triangle_patches
from postprocess.view.outlines import packed_outlines, rings_of


@pytest.fixture(params=[False, True], ids=["closed", "sea"])
def any_sea(request: pytest.FixtureRequest, icosahedral_mesh: VoronoiMesh) -> VoronoiMesh:
    return culled(icosahedral_mesh, icosahedral_mesh.lat_cell < 0.5) if request.param else icosahedral_mesh


@pytest.mark.parametrize(
    ("place", "patches"), [("nCells", cell_patches), ("nVertices", triangle_patches), ("nEdges", edge_patches)]
)
def test_rings_are_the_polygons_of_the_figures(any_sea: VoronoiMesh, place: str, patches: object) -> None:
    expected: Patches = patches(any_sea)  # type: ignore[operator]
    rings, counts = rings_of(any_sea, place)
    points = normalize(np.concatenate([any_sea.vertex_points, any_sea.cell_points, any_sea.edge_points]))
    inside = np.arange(expected.corners.shape[1]) < expected.counts[:, None]
    np.testing.assert_array_equal(counts, expected.counts)
    np.testing.assert_allclose(points[rings], expected.corners[inside], atol=1e-12)


def test_edges_are_left_out_where_nothing_needs_them(any_sea: VoronoiMesh) -> None:
    outlines = packed_outlines(any_sea, {"nCells", "nVertices"})
    of_edges = any_sea.n_edges if has_walls(any_sea) else 0
    assert outlines["points"] == any_sea.n_vertices + any_sea.n_cells + of_edges
    assert packed_outlines(any_sea, {"nEdges"})["points"] == any_sea.n_vertices + any_sea.n_cells + any_sea.n_edges


def test_the_coast_is_its_walls(any_sea: VoronoiMesh) -> None:
    outlines = packed_outlines(any_sea, {"nCells"})
    assert outlines["closed"] != has_walls(any_sea)
    assert outlines["coast"]["count"] == 2 * np.count_nonzero(any_sea.cells_on_edge < 0)
