"""Maps of blocks: each cell in the colour of its block, neighbours in different ones, missing cells in none."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.image import imread

from mesh import Partition, VoronoiMesh
from mesh.partition.cell_graph import cell_graph
from postprocess.figures.block_map import COLOURS, block_figure, colours_of_cells, write_block_figure
from postprocess.figures.patches import cell_patches
from postprocess.figures.projections import mollweide_raster, orthographic_polygons
from tests.cut_mesh import without_cap


def sectors(mesh: VoronoiMesh) -> Partition:
    blocks = np.floor(mesh.lon_cell).astype(np.int32) + 7 * (mesh.lat_cell > 0.0)
    return Partition(blocks.astype(np.int32), 14)


def test_neighbouring_blocks_differ(any_mesh: VoronoiMesh) -> None:
    graph, partition = cell_graph(any_mesh), sectors(any_mesh)
    colours = colours_of_cells(graph, partition)
    blocks = partition.block_of_cell
    assert np.all(
        (colours[graph.owners] != colours[graph.neighbours])[blocks[graph.owners] != blocks[graph.neighbours]]
    )
    assert len({*zip(blocks.tolist(), colours.tolist(), strict=True)}) == len(np.unique(blocks))


def test_each_cell_has_the_colour_of_its_block(icosahedral_mesh: VoronoiMesh) -> None:
    graph, partition = cell_graph(icosahedral_mesh), sectors(icosahedral_mesh)
    colours = colours_of_cells(graph, partition)
    figure = block_figure(icosahedral_mesh, graph, partition)
    assert figure.get_suptitle() == "642 cells in 14 blocks"
    figure.draw_without_rendering()
    drawn = 0
    for axes, longitude, latitude in zip(
        figure.axes, np.radians([270.0, 90.0]), np.radians([25.0, -25.0]), strict=True
    ):
        collection = axes.collections[-1]
        shown = orthographic_polygons(cell_patches(icosahedral_mesh), longitude, latitude).shown
        expected = [to_rgba(COLOURS[int(colour)]) for colour in colours[shown]]
        np.testing.assert_allclose(collection.get_facecolors(), expected)
        assert collection.get_edgecolors().shape == (1, 4)  # lines round cells, of one colour
        drawn += len(shown)
    assert drawn >= icosahedral_mesh.n_cells


def test_small_cells_have_no_outlines(icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("postprocess.figures.block_map.LEAST_CELL_WIDTH", 1000.0)
    figure = block_figure(icosahedral_mesh, cell_graph(icosahedral_mesh), sectors(icosahedral_mesh))
    figure.draw_without_rendering()
    assert len(figure.axes[0].collections[-1].get_edgecolors()) > 300


def test_pixels_show_the_nearest_cell_unless_it_is_missing(larger_mesh: VoronoiMesh) -> None:
    for mesh in (larger_mesh, without_cap(larger_mesh)):
        graph, partition = cell_graph(mesh), sectors(mesh)
        image = np.ma.filled(block_figure(mesh.cell_points, graph, partition).axes[0].images[-1].get_array(), np.nan)
        longitude, latitude = mollweide_raster(*image.shape)
        longitude = (longitude + np.radians(270.0)) % (2.0 * np.pi)
        # Away from the sides of sectors, and from the coast, pixels know their block by their place.
        colours = colours_of_cells(graph, partition)
        sector = np.floor(longitude).astype(int) + 7 * (latitude > 0.0)
        of_block = np.full(14, np.nan)
        of_block[partition.block_of_cell] = colours
        inner = (np.abs(longitude % 1.0 - 0.5) < 0.3) & (longitude < 6.1) & (np.abs(latitude) > 0.1)
        inner &= np.abs(latitude) < 0.45
        np.testing.assert_array_equal(image.ravel()[inner], of_block[sector[inner]])
        missing = np.isnan(image.ravel())
        if mesh is larger_mesh:
            assert not missing.any()
        else:
            assert missing[latitude > 0.7].all()
            assert missing[(latitude > -1.4) & (latitude < 0.5)].sum() == 0


@pytest.mark.parametrize("whole", [True, False])
def test_the_picture_is_written(icosahedral_mesh: VoronoiMesh, tmp_path: Path, whole: bool) -> None:
    where = icosahedral_mesh if whole else icosahedral_mesh.cell_points
    path = write_block_figure(where, cell_graph(icosahedral_mesh), sectors(icosahedral_mesh), tmp_path / "blocks.png")
    assert imread(path).std() > 0.05
    assert [each.name for each in tmp_path.iterdir()] == ["blocks.png"]
