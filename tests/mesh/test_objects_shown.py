"""How objects show themselves: text, table, values in words; meshes, and what is made of them."""

import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from mesh import MeshRequest, Partition, VoronoiMesh, build_operators, find_region, mesh_quality
from mesh.discrete.build import mesh_from_points
from mesh.discrete.walls import seas_and_coasts
from mesh.generation.generators import icosahedral_points
from mesh.parts.culling import culled
from mesh.shown import Rows, Shown, as_html, as_text, in_kilometres, in_words, span


class Thing(Shown):
    def _title_and_rows(self) -> tuple[str, Rows]:
        return "Thing <1>", {"a & b": "<b>'bold'</b>", "size": "2"}


def test_the_same_words_as_text_and_as_escaped_table() -> None:
    assert repr(Thing()) == "<Thing <1>\n  a & b: <b>'bold'</b>\n  size: 2>"
    table = Thing()._repr_html_()
    assert "<strong>Thing &lt;1&gt;</strong>" in table
    assert ">a &amp; b</th>" in table
    assert ">&lt;b&gt;&#x27;bold&#x27;&lt;/b&gt;</td>" in table
    assert "<b>" not in table
    assert "color" not in table
    assert as_text("Nothing", {}) == "<Nothing>"
    assert as_html("Nothing", {}).count("<tr>") == 0
    with pytest.raises(NotImplementedError, match="Shown has no title and rows to show"):
        repr(Shown())


def test_values_in_words() -> None:
    assert in_words(np.float32(0.5), "m") == "0.5 m"
    assert in_words(6371220.0) == "6371220"
    assert in_words(10**12) == "1000000000000"
    assert in_words(np.zeros((3, 4))) == "array of shape (3, 4)"
    assert in_words(in_words) == "in_words"
    assert in_words(True) == "True"
    assert in_words("two\n lines") == "two lines"
    assert in_words("x" * 100) == "x" * 77 + "..."
    assert len(in_words(list(range(10_000)))) < 40
    assert (span(np.array([1.0, 3.0]), "m"), span(np.ones(2), "m")) == ("1 to 3 m", "1 m")
    assert span(np.zeros(0), "m") == "no values"
    assert (in_kilometres(999.0), in_kilometres(6371220.0)) == ("999 m", "6371.22 km")


def test_a_mesh_shows_its_measures(small_mesh: VoronoiMesh) -> None:
    quality, spacing = mesh_quality(small_mesh), small_mesh.dc_edge
    assert repr(small_mesh).splitlines() == [
        "<VoronoiMesh of 162 cells",
        "  edges, vertices: 480, 320",
        "  density: uniform",
        f"  spacing: mean {spacing.mean():.4g} radians, least {spacing.min():.4g} radians, "
        f"largest {spacing.max():.4g} radians",
        f"  sigma: mean {quality.sigma_avg:.4f}, least {quality.sigma_min:.4f} "
        "(shortest over longest distance to a neighbour)",
        "  irregular cells: 12 with more or fewer than six edges>",
    ]
    on_earth = repr(small_mesh.scaled(6371220.0))
    assert "radius: 6371.22 km\n" in on_earth
    assert f"spacing: mean {spacing.mean() * 6371.22:.6g} km, least" in on_earth


def test_a_mesh_shows_its_coast(icosahedral_mesh: VoronoiMesh) -> None:
    assert "coast" not in repr(icosahedral_mesh)
    sea = culled(icosahedral_mesh, np.abs(icosahedral_mesh.lat_cell) > 0.5)
    assert seas_and_coasts(sea) == (2, 2)
    share = 100.0 * sea.area_cell.sum() / (4.0 * np.pi)
    assert f"coast: 2 seas, 2 coasts; the sea covers {share:.3g} % of the sphere" in repr(sea)
    quality = mesh_quality(sea)
    assert f"sigma: mean {quality.sigma_avg:.4f}, least {quality.sigma_min:.4f} (" in repr(sea)
    inside = sea.cells_on_edge.min(axis=1) >= 0
    assert f"largest {sea.dc_edge[inside].max():.4g} radians" in repr(sea)
    beyond_walls = replace(sea, dc_edge=np.where(inside, sea.dc_edge, 1.0))
    assert repr(beyond_walls) == repr(sea)


def test_requests_regions_partitions_and_operators(small_mesh: VoronoiMesh) -> None:
    assert repr(MeshRequest(642)) == "<MeshRequest for 642 cells\n  density: uniform\n  method: lbfgs>"
    request = repr(MeshRequest(nested=small_mesh, density=np.sin, seed=3))
    assert "for as many cells as the density asks for\n" in request
    assert "density: sin" in request
    assert "seed: 3" in request
    assert "nested: in a mesh of 162 cells on the" in request
    assert MeshRequest(642)._repr_html_().startswith("<div><strong>MeshRequest for 642 cells</strong>")
    assert repr(find_region("280,350,10,60")).startswith("<Region 280,350,10,60\n  points in it: told exactly")
    partition = Partition(np.array([0, 0, 1, 1, 1]), 2, (1,))
    assert repr(partition).splitlines() == [
        "<Partition of 5 cells into 2 blocks",
        "  cells of a block: 2 to 3, 2.5 in the mean",
        "  mended blocks: 1>",
    ]
    operators = build_operators(small_mesh)
    assert "\n  made: " not in repr(operators)
    _ = operators.curl
    assert "\n  made: curl\n" in repr(operators)
    assert "made when asked for: divergence, gradient, perp" in repr(operators)


def test_the_command_line_reads_a_request_without_its_package() -> None:
    program = (
        "import runpy, sys\n"
        "made = runpy.run_path('mesh/mesh_request.py')['MeshRequest']\n"
        "assert made(42).method == 'lbfgs' and 'mesh' not in sys.modules and 'numpy' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.slow
def test_meshes_of_many_cells_show_themselves_at_once() -> None:
    mesh = mesh_from_points(icosahedral_points(7))
    sea = culled(mesh, mesh.lat_cell < 0.5)
    assert mesh.n_cells == 163842
    for shown in (mesh, sea):
        start = time.process_time()
        repr(shown)
        assert time.process_time() - start < 1.0
