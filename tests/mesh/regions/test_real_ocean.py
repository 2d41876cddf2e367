"""The seas with real coasts: points that everyone knows, walls, areas, and the coastline."""

import sys

import numpy as np
import pytest

from mesh import MeshError
from mesh.arrays import Array
from mesh.geometry.sphere import fibonacci_points, from_lonlat
from mesh.regions import real_ocean
from mesh.regions.find import find_region
from tests.mesh.regions.rings import area_within, crossings, steps

for package in ("landmetrics", "shapely"):
    pytest.importorskip(package, reason=f"{package} is not installed; pip install 'trisk[coast]' brings it")


def at(*places: tuple[float, float]) -> Array:
    """Unit vectors at degrees east and north."""
    return from_lonlat(*np.radians(places).T)


PARIS, SAHARA, GREENLAND, CASPIAN, GENEVA = (2.35, 48.86), (20, 25), (-40, 75), (51, 42), (6.5, 46.4)
MID_ATLANTIC, GULF, CARIBBEAN, NORTH_SEA, LABRADOR = (-40, 30), (-90, 25), (-75, 15), (3, 56), (-52, 58)
PACIFIC, PANAMA_BAY, MEDITERRANEAN, HUDSON, BALTIC = (-150, 0), (-79.3, 8.2), (18, 35), (-85, 60), (20, 58)
JAMES, UNGAVA, ARCTIC, SOUTH_ATLANTIC, ROSS, DATE_LINE = (
    (-80.5, 53),
    (-67.5, 59.5),
    (0, 85),
    (-20, -5),
    (-175, -76),
    (180, 0),
)


def test_what_is_sea_and_what_is_land() -> None:
    ocean = find_region("world-ocean")
    seas = (MID_ATLANTIC, GULF, CARIBBEAN, NORTH_SEA, LABRADOR, PACIFIC, PANAMA_BAY, MEDITERRANEAN, HUDSON, BALTIC)
    assert ocean.contains(at(*seas, JAMES, UNGAVA, ARCTIC, SOUTH_ATLANTIC, ROSS, DATE_LINE, (0, 90))).all()
    assert not ocean.contains(at(PARIS, SAHARA, GREENLAND, CASPIAN, GENEVA, (80, -85), (0, -90), (135, -25))).any()
    atlantic = find_region("north-atlantic")
    assert atlantic.contains(at(MID_ATLANTIC, GULF, CARIBBEAN, NORTH_SEA, LABRADOR, (-20, 0.01), (0, 64.9))).all()
    beyond = (PACIFIC, PANAMA_BAY, MEDITERRANEAN, HUDSON, BALTIC, JAMES, UNGAVA, ARCTIC, (-20, -0.01))
    assert not atlantic.contains(at(*beyond, (0, 65.1), PARIS, SAHARA, (-100, 40))).any()


def test_areas_are_those_of_the_earth() -> None:
    points = fibonacci_points(50000)
    assert np.isclose(find_region("world-ocean").contains(points).mean(), 0.708, atol=0.01)
    square_kilometres = 4 * np.pi * 6371.0**2 * find_region("north-atlantic").contains(points).mean()
    assert 40e6 < square_kilometres < 46e6


def test_distances_are_radians_to_the_coast_or_the_wall() -> None:
    atlantic, ocean = find_region("north-atlantic"), find_region("world-ocean")
    equator, off_africa, inland = at((-20, 2.0), (-40, 25), SAHARA)
    assert np.isclose(np.degrees(atlantic.distance(equator[None])[0]), 2.0, atol=1e-4)
    assert ocean.distance(equator[None])[0] > np.radians(4.0)
    kilometres = 6371.0 * ocean.distance(np.stack([off_africa, inland]))
    assert 1500 < kilometres[0] < 2100
    assert -1000 < kilometres[1] < -500
    np.testing.assert_array_equal(ocean.distance(at((180, 0.0))), ocean.distance(at((-180, 0.0))))


def test_the_coastline_of_the_north_atlantic() -> None:
    atlantic, spacing = find_region("north-atlantic"), np.radians(1.5)
    rings = atlantic.coastline(spacing)
    assert 4 <= len(rings) <= 12  # Great Britain, Ireland, Newfoundland, Cuba and Hispaniola at least
    assert crossings(rings) == 0
    assert 0.15 < steps(rings).min() / spacing <= steps(rings).max() / spacing < 0.26
    inside = atlantic.contains(fibonacci_points(50000)).mean()
    assert np.isclose(area_within(rings), 4 * np.pi * inside, rtol=0.05)  # small islands are sea
    away = atlantic.distance(np.concatenate(rings))
    assert np.abs(away).max() < spacing
    assert np.abs(away).mean() < 0.25 * spacing


def test_america_and_the_old_world_are_one_piece_each_however_coarse() -> None:
    """Canals cut both in the data."""
    rings = find_region("world-ocean").coastline(np.radians(3.0))
    for west, east, isthmus in (((-100, 40), (-60, -10), (-79.6, 9.15)), ((20, 0), (90, 60), (32.5, 30.5))):
        places = [min(rings, key=lambda ring: np.linalg.norm(ring - at(here), axis=1).min()) for here in (west, east)]
        assert places[0] is places[1]
        assert not find_region("world-ocean").contains(at(isthmus), np.radians(0.1)).any()


def test_what_is_missing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    real_ocean._table.cache_clear()
    monkeypatch.setitem(sys.modules, "landmetrics", None)
    with pytest.raises(
        MeshError, match=r"a sea with its real coasts needs landmetrics, which is not installed; pip install 'trisk\["
    ):
        find_region("world-ocean").contains(at(PARIS))
