"""Boxes: their edges to the last digits, their area, what they refuse, and their coastline."""

import numpy as np
import pytest

from mesh import MeshError
from mesh.arrays import Array
from mesh.geometry.sphere import arc_length, fibonacci_points, from_lonlat
from mesh.regions.find import find_region
from tests.mesh.regions.rings import area_within, crossings, left_of, steps


def at(*places: tuple[float, float]) -> Array:
    """Unit vectors at degrees east and north."""
    return from_lonlat(*np.radians(places).T)


@pytest.mark.parametrize("text", ["280,350,10,60", "-80,-10,10,60", " -80, -10, 1e1, 60. ", "280,-10,10,60"])
def test_edges_are_exact(text: str) -> None:
    region = find_region(text)
    inside = at((280, 10), (350, 60), (280, 60), (315, 60), (280, 35), (349.999999, 59.999999), (-45, 10.000001))
    assert region.contains(inside).all()
    outside = at((279.999999, 35), (350.000001, 35), (315, 60.000001), (315, 9.999999), (0, 35), (135, 35), (315, -35))
    assert not region.contains(outside).any()


@pytest.mark.parametrize(("text", "middle"), [("170,-170,-5,5", 180.0), ("350,10,-5,5", 0.0), ("-10,10,-5,5", 0.0)])
def test_over_the_date_line_and_greenwich(text: str, middle: float) -> None:
    region = find_region(text)
    assert region.contains(at((middle, 0), (middle - 10, 0), (middle + 10, 5), (middle - 9.9, -5))).all()
    assert not region.contains(at((middle - 10.1, 0), (middle + 10.1, 0), (middle + 180, 0))).any()
    rings = region.coastline(np.radians(1.0))
    assert len(rings) == 1
    assert np.isclose(area_within(rings), np.radians(20) * 2 * np.sin(np.radians(5)), rtol=0.01)


def test_distance_is_that_to_meridians_parallels_and_corners() -> None:
    distance = find_region("0,40,0,60").distance
    north, east, south = np.degrees(distance(at((20, 59), (39.5, 10), (20, -3))))
    assert np.isclose(north, 1.0, atol=1e-6)
    assert np.isclose(east, np.degrees(np.arcsin(np.cos(np.radians(10)) * np.sin(np.radians(0.5)))), atol=1e-6)
    assert np.isclose(south, -3.0, atol=1e-6)
    corner, far = at((40, 0)), at((45, -5))
    np.testing.assert_allclose(distance(far), -arc_length(corner, far), rtol=1e-9)


def test_area_from_distances_and_points() -> None:
    region, points = find_region("280,350,10,60"), fibonacci_points(40000)
    exact = np.radians(70) * (np.sin(np.radians(60)) - np.sin(np.radians(10)))
    for inside in (region.contains(points), region.distance(points) > 0.0):
        assert np.isclose(4.0 * np.pi * inside.mean(), exact, rtol=2e-3)


def test_the_coastline_has_the_sea_to_its_left() -> None:
    region, spacing = find_region("280,350,10,60"), np.radians(2.0)
    rings = region.coastline(spacing)
    assert len(rings) == 1
    exact = np.radians(70) * (np.sin(np.radians(60)) - np.sin(np.radians(10)))
    corners = (4.0 - np.pi) * (0.5 * spacing) ** 2
    assert corners < exact - area_within(rings) < 2.5 * corners
    assert crossings(rings) == 0
    assert 0.2 < steps(rings).min() / spacing <= steps(rings).max() / spacing < 0.26
    away = np.degrees(region.distance(np.concatenate(rings)))
    assert away.min() > -0.02
    assert away.max() < 0.5  # corners are rounded
    assert np.median(np.abs(away)) < 0.005
    assert (region.distance(left_of(rings, 0.1 * spacing)) > 0.05 * spacing).all()


def test_a_whole_circle_has_no_meridian_and_the_whole_sphere_no_coast() -> None:
    band = find_region("-180,180,-20,20")
    assert band.contains(at((180, 0), (-179.99, 0), (0, 20), (77, -20))).all()
    assert np.isclose(band.distance(at((180, 1)))[0], np.radians(19))
    south, north = sorted(band.coastline(np.radians(10.0)), key=lambda ring: float(ring[:, 2].mean()))
    assert np.cross(south[0], south[1])[2] > 0.0 > np.cross(north[0], north[1])[2]
    whole = find_region("0,360,-90,90")
    assert whole.contains(fibonacci_points(100)).all()
    assert whole.coastline(0.1) == []


def test_a_box_may_hold_a_pole() -> None:
    region = find_region("-180,180,60,90")
    assert region.contains(at((0, 90), (123, 60))).all()
    (ring,) = region.coastline(np.radians(2.0))
    assert np.isclose(area_within([ring]), 2 * np.pi * (1 - np.sin(np.radians(60))), rtol=1e-3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "280,350,60,10",
            "the box 280,350,60,10 is upside down: its south, 60, is not below its north, 10; write WEST",
        ),
        ("280,350,10,10", "is upside down"),
        ("280,350,10,95", "has latitudes beyond the poles; write WEST,EAST,SOUTH,NORTH in degrees"),
        ("280,280,10,60", "has no width; write WEST,EAST,SOUTH,NORTH in degrees, such as 280,350,10,60, and -180,180"),
        ("180,-180,10,60", "has no width"),
        ("0,400,10,60", "has longitudes that go round more than once"),
        ("280,350,10", "there is no region named '280,350,10'; choose one of north-atlantic, world-ocean, a box"),
        ("280,350,10,nan", "there is no region named"),
        (
            "atlantis",
            "there is no region named 'atlantis'; choose one of north-atlantic, world-ocean, a box in degrees",
        ),
    ],
)
def test_what_is_no_box_is_refused(text: str, words: str) -> None:
    with pytest.raises(MeshError) as error:
        find_region(text)
    assert words in str(error.value)


def test_a_sea_narrower_than_the_spacing_and_odd_spacings_are_refused() -> None:
    region = find_region("0,1,0,1")
    with pytest.raises(MeshError, match=r"0,1,0,1: no sea is as wide as the spacing of 2 degrees; take another region"):
        region.coastline(np.radians(2.0))
    with pytest.raises(MeshError, match=r"a spacing of nan radians; ask for one between 1e-05 and 0.25"):
        region.coastline(float("nan"))
