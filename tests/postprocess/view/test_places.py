"""Where the points of pages are, and that polygons come together from them, at the seams of planes too."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from mesh import VoronoiMesh, hexagon_mesh
from mesh.arrays import Array
from mesh.geometry.surface import surface_of
from postprocess.view.outlines import packed_outlines
from tests.postprocess.view.test_packing import unpacked

ROW = 0.5 * np.sqrt(3.0)


@pytest.fixture(params=["irregular", "hexagons", "channel", "box"])
def plane(request: pytest.FixtureRequest, irregular_plane: VoronoiMesh) -> VoronoiMesh:
    if request.param == "irregular":
        return irregular_plane
    periodic = {"hexagons": "xy", "channel": "x", "box": "none"}[request.param]
    return hexagon_mesh((8e5, 6e5 * ROW), (8, 6), periodic)


def places_of(outlines: dict[str, Any]) -> Array:
    """The points (n, 2) of a page of a plane, metres from where the plane begins, as the page makes them."""
    plane, bits = outlines["plane"], outlines["lengthBits"]
    steps = np.stack([unpacked(outlines[axis], 1, bits)[0] for axis in "xy"], axis=1)
    return np.array(plane["low"]) - plane["begin"] + steps / (2**bits - 1) * plane["span"]


def test_points_of_the_sphere_come_back(icosahedral_mesh: VoronoiMesh) -> None:
    outlines = packed_outlines(icosahedral_mesh, {"nCells"})
    top = 2 ** outlines["angleBits"] - 1
    longitude = unpacked(outlines["longitude"], 1, 24)[0] / top * 2.0 * np.pi
    latitude = (unpacked(outlines["latitude"], 1, 24)[0] / top - 0.5) * np.pi
    expected = [
        np.concatenate([getattr(icosahedral_mesh, f"{name}_{at}") for at in ("vertex", "cell")])
        for name in ("lon", "lat")
    ]
    assert np.abs(np.exp(1j * longitude) - np.exp(1j * expected[0])).max() <= np.pi / top * 1.001
    np.testing.assert_allclose(latitude, expected[1], atol=0.5 * np.pi / top * 1.001)
    assert "plane" not in outlines


def test_points_of_a_plane_come_back(plane: VoronoiMesh) -> None:
    outlines = packed_outlines(plane, {"nEdges"})
    expected = np.concatenate([plane.vertex_points, plane.cell_points, plane.edge_points])[:, :2]
    found = places_of(outlines) + outlines["plane"]["begin"]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=0.501 * outlines["plane"]["span"] / (2**24 - 1))
    assert outlines["plane"]["periods"] == [plane.x_period, plane.y_period]
    assert outlines["spacing"] == plane.dc_edge.min() / max(outlines["plane"]["extent"])


def test_what_is_shown_of_a_plane() -> None:
    periodic, channel, box = (hexagon_mesh((8e5, 6e5 * ROW), (8, 6), which) for which in ("xy", "x", "none"))
    of_period = packed_outlines(periodic, {"nCells"})["plane"]
    assert (of_period["begin"], of_period["extent"]) == ([0.0, 0.0], [8e5, periodic.y_period])
    of_channel = packed_outlines(channel, {"nCells"})["plane"]
    assert (of_channel["begin"][0], of_channel["extent"][0]) == (0.0, 8e5)
    assert of_channel["begin"][1] == channel.y_vertex.min()
    assert of_channel["extent"][1] == np.ptp(channel.y_vertex)
    of_box = packed_outlines(box, {"nCells"})["plane"]
    assert of_box["extent"] == [np.ptp(box.x_vertex), np.ptp(box.y_vertex)]


def test_periods_may_begin_elsewhere() -> None:
    mesh = hexagon_mesh((8e5, 6e5 * ROW), (8, 6))
    moved = replace(mesh, **{f"x_{place}": getattr(mesh, f"x_{place}") - 4e5 for place in ("cell", "edge", "vertex")})
    plane = packed_outlines(moved, {"nCells"})["plane"]
    assert plane["begin"] == [moved.x_cell.min(), 0.0]
    np.testing.assert_allclose(
        places_of(packed_outlines(moved, {"nCells"}))[moved.n_vertices :] + plane["begin"],
        moved.cell_points[:, :2],
        atol=0.1,
    )


@pytest.mark.parametrize("place", ["nCells", "nVertices", "nEdges"])
def test_polygons_have_their_areas_at_seams_too(plane: VoronoiMesh, place: str) -> None:
    """Each corner at its image nearest to the one before, as the page takes them, gives the whole polygon."""
    outlines = packed_outlines(plane, {place})
    packed = outlines["places"][place]
    counts, rings = unpacked(packed["counts"], 1, 8)[0], unpacked(packed["rings"], 1, 24)[0]
    points, surface = np.column_stack([places_of(outlines), np.zeros(outlines["points"])]), surface_of(plane)
    areas, starts = [], np.concatenate([[0], np.cumsum(counts)])
    for first, end in pairwise(starts):
        corners = points[rings[first:end]]
        ways = surface.shortest(np.diff(corners, axis=0, append=corners[:1]))
        assert np.abs(ways.sum(axis=0)).max() < 1e-3  # it closes where it began
        x, y = np.cumsum(ways, axis=0)[:, :2].T
        areas.append(0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    expected = {
        "nCells": plane.area_cell,
        "nVertices": plane.area_triangle,
        "nEdges": 0.5 * plane.dc_edge * plane.dv_edge * np.where(plane.cells_on_edge.min(axis=1) < 0, 0.5, 1.0),
    }[place]
    np.testing.assert_allclose(areas, expected, rtol=2e-5)
