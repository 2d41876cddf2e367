"""Regular hexagons on planes: sizes, walls, the discrete identities, and what cannot be made."""

from collections.abc import Sequence

import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh, hexagon_mesh, mesh_quality, validate_mesh
from mesh.discrete.operators import normal_component, velocity_at_cells
from mesh.discrete.walls import wall_edges
from mesh.integrals.quadrature import cell_means
from mesh.parts.culling import culled

ROW = 0.5 * np.sqrt(3.0)
DISTANCE = 5e3


def plane(columns: int, rows: int, periodic: str) -> VoronoiMesh:
    return hexagon_mesh((columns * DISTANCE, rows * ROW * DISTANCE), (columns, rows), periodic)


@pytest.fixture(params=["xy 6 8", "x 5 7", "x 6 6", "none 4 5", "none 5 4", "xy 3 4"])
def mesh(request: pytest.FixtureRequest) -> VoronoiMesh:
    periodic, columns, rows = request.param.split()
    return plane(int(columns), int(rows), periodic)


def test_identities_hold_and_cells_are_equal_hexagons(mesh: VoronoiMesh) -> None:
    assert max(validate_mesh(mesh).values()) < 1e-14
    np.testing.assert_allclose(mesh.area_cell, ROW * DISTANCE**2, rtol=1e-13)
    np.testing.assert_allclose(mesh.dc_edge, DISTANCE, rtol=1e-13)
    np.testing.assert_allclose(mesh.dv_edge, DISTANCE / np.sqrt(3.0), rtol=1e-13)
    np.testing.assert_array_equal(mesh.n_edges_on_cell, 6)
    assert not any(getattr(mesh, f"z_{place}").any() for place in ("cell", "edge", "vertex"))
    quality = mesh_quality(mesh)
    assert quality.q_min == pytest.approx(1.0)
    assert quality.residual < 1e-13


def test_a_uniform_flow_is_found_again_in_all_cells(mesh: VoronoiMesh) -> None:
    eastward, northward = velocity_at_cells(mesh, normal_component(mesh, 3.0, -2.0))
    np.testing.assert_allclose(eastward, 3.0, rtol=1e-12)
    np.testing.assert_allclose(northward, -2.0, rtol=1e-12)


def test_means_over_cells_are_those_of_hexagons(mesh: VoronoiMesh) -> None:
    """The mean of x^2 is that of the centre and a sixth of the squared length of sides, 5/24 of it."""
    means = cell_means(mesh, lambda x, y: x**2)
    side = DISTANCE / np.sqrt(3.0)
    np.testing.assert_allclose(means, mesh.x_cell**2 + 5.0 / 24.0 * side**2, rtol=1e-12)


@pytest.mark.parametrize(("periodic", "walls"), [("xy", 0), ("x", 4 * 6), ("none", 4 * 6 + 4 * 4 - 2)])
def test_walls_stand_where_there_is_no_period(periodic: str, walls: int) -> None:
    mesh = plane(6, 4, periodic)
    assert len(wall_edges(mesh)) == walls
    assert (mesh.x_period > 0.0, mesh.y_period > 0.0) == ("x" in periodic, "y" in periodic)


def test_a_periodic_plane_may_have_islands() -> None:
    whole = plane(6, 6, "xy")
    kept = ~np.isin(np.arange(36), [7, 8, 22])
    island = culled(whole, kept)
    assert max(validate_mesh(island).values()) < 1e-14
    assert len(wall_edges(island)) == 10 + 6
    belt = culled(whole, np.arange(36) < 18)
    assert max(validate_mesh(belt).values()) < 1e-14


def test_positions_lie_within_periods_and_centres_in_the_plane() -> None:
    mesh = plane(6, 4, "xy")
    for place in ("cell", "edge", "vertex"):
        for axis, period in (("x", mesh.x_period), ("y", mesh.y_period)):
            values = getattr(mesh, f"{axis}_{place}")
            assert values.min() >= 0.0
            assert values.max() < period
    box = plane(6, 4, "none")
    np.testing.assert_allclose(box.cell_points.min(axis=0), [0.25 * DISTANCE, 0.5 * ROW * DISTANCE, 0.0], rtol=1e-12)
    np.testing.assert_allclose(box.cell_points.max(axis=0), [5.75 * DISTANCE, 3.5 * ROW * DISTANCE, 0.0], rtol=1e-12)


def test_a_rounded_height_is_made_exact() -> None:
    mesh = hexagon_mesh((1e6, 866025.4), (10, 10))
    assert mesh.y_period == pytest.approx(1e6 * ROW, rel=1e-15)


@pytest.mark.parametrize(
    ("lengths", "counts", "periodic", "words"),
    [
        (
            (1e6, 1e6),
            (10, 10),
            "xy",
            "are 866025.4038 m high, not 1000000 m; give that .* 12 rows of 10",
        ),
        ((1e6, 1e6), (10, 11), "xy", "11 rows of hexagons cannot repeat themselves in y, .* take 12"),
        ((1e6, 1e6), (2, 10), "x", "2 hexagons in a row are too few; a plane periodic in x needs 3"),
        ((1e6, 1e6), (4, 2), "xy", "2 hexagons in a column are too few; a plane periodic in xy needs 4"),
        ((1e6, 1e6), (4, 4), "y", "cannot be periodic in 'y'; choose one of xy, x, none"),
        ((1e6, -1.0), (4, 4), "x", "a length of the plane is -1 m"),
        ((1e6,), (4, 4), "x", "give two numbers"),
        ((1e6, 1e6), (4, 4.5), "x", "must be a whole number"),
    ],
)
def test_what_cannot_be_made_is_told(
    lengths: Sequence[float], counts: Sequence[int], periodic: str, words: str
) -> None:
    with pytest.raises(MeshError, match=words):
        hexagon_mesh(lengths, counts, periodic)


def test_planes_and_spheres_are_not_scaled_to_each_other(small_mesh: VoronoiMesh) -> None:
    mesh = plane(3, 4, "xy")
    assert mesh.scaled(0.0) is mesh
    with pytest.raises(MeshError, match="the mesh is on a plane, but one on a sphere is asked for"):
        mesh.scaled(1.0)
    with pytest.raises(MeshError, match="the mesh is on a sphere, but one on a plane is asked for"):
        small_mesh.scaled(0.0)
    assert "a plane that repeats itself after 15 km in x and 17.3" in repr(mesh)
