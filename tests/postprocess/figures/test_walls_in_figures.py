"""Figures of meshes with walls: polygons cover the cells that are there and no more, and land is behind them."""

import warnings

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from mesh import VoronoiMesh
from mesh.arrays import Array
from mesh.geometry.sphere import triangle_area
from mesh.parts.culling import culled
from postprocess.figures.field_map import plot_field
from postprocess.figures.maps import LAND
from postprocess.figures.patches import Patches, cell_patches, edge_patches, triangle_patches
from postprocess.figures.plots import mesh_figure


@pytest.fixture
def sea(larger_mesh: VoronoiMesh) -> VoronoiMesh:
    kept = larger_mesh.lat_cell < 0.6
    kept[np.argmin(larger_mesh.lat_cell)] = False
    return culled(larger_mesh, kept)


def areas_of(patches: Patches) -> Array:
    """Areas (n,) of the polygons, by triangles from their first corners."""
    first, rest = patches.corners[:, 0], patches.corners[:, 1:]
    parts = [triangle_area(first, rest[:, k], rest[:, k + 1]) for k in range(rest.shape[1] - 1)]
    return np.sum(parts, axis=0)


def test_polygons_cover_the_sea(sea: VoronoiMesh) -> None:
    """Those at vertices are their triangles as far as there are cells, those at edges their quadrilaterals."""
    np.testing.assert_allclose(areas_of(cell_patches(sea)), sea.area_cell, rtol=1e-9)
    np.testing.assert_allclose(areas_of(triangle_patches(sea)), sea.area_triangle, rtol=1e-9)
    quadrilaterals = areas_of(edge_patches(sea))
    assert quadrilaterals.sum() == pytest.approx(sea.area_cell.sum(), rel=1e-9)
    walls = sea.cells_on_edge[:, 1] < 0
    half = 0.25 * sea.dc_edge * sea.dv_edge
    np.testing.assert_allclose(quadrilaterals[walls], half[walls], rtol=0.01)
    np.testing.assert_allclose(quadrilaterals[~walls], 2.0 * half[~walls], rtol=0.01)


@pytest.mark.parametrize(
    "options",
    [
        {"projection": "mollweide"},
        {"projection": "orthographic"},
        {"centre": (20.0, 30.0), "extent": 40.0},
        {"centre": (20.0, 30.0), "extent": 40.0, "projection": "cylindrical"},
    ],
    ids=str,
)
def test_land_is_behind_all_else(sea: VoronoiMesh, larger_mesh: VoronoiMesh, options: dict) -> None:
    def grey_behind(mesh: VoronoiMesh, name: str) -> bool:
        axes = plot_field(mesh, name, ax=Figure().subplots(), colour_bar=False, **options)
        lowest = axes.collections[-1].get_zorder()
        return any(patch.get_facecolor() == to_rgba(LAND) and patch.get_zorder() < lowest for patch in axes.patches)

    for name in ("area_cell", "area_triangle", "dc_edge"):
        assert grey_behind(sea, name)
        assert not grey_behind(larger_mesh, name)


def test_distributions_are_those_of_what_has_neighbours(sea: VoronoiMesh) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = mesh_figure(sea)
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert len(titles) == 2
    assert not any("nan" in title for title in titles)
    assert sum(patch.get_height() for patch in figure.axes[-1].patches) == np.count_nonzero(sea.boundary_vertex == 0)
