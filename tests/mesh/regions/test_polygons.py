"""Polygons of GeoJSON files: what they hold, and what is refused in a sentence."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mesh import MeshError, Region
from mesh.arrays import Array
from mesh.geometry.sphere import fibonacci_points, from_lonlat
from mesh.regions.find import find_region
from tests.mesh.regions.rings import area_within, crossings

pytest.importorskip("shapely", reason="shapely is not installed; pip install 'trisk[coast]' brings it")

Ring = list[list[float]]


def at(*places: tuple[float, float]) -> Array:
    """Unit vectors at degrees east and north."""
    return from_lonlat(*np.radians(places).T)


def box(west: float, east: float, south: float, north: float) -> Ring:
    return [[west, south], [east, south], [east, north], [west, north], [west, south]]


def polygon(*rings: Ring) -> dict[str, Any]:
    return {"type": "Polygon", "coordinates": list(rings)}


@pytest.fixture
def region(tmp_path: Path) -> Any:
    def read(content: Any) -> Region:
        path = tmp_path / "sea.geojson"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return find_region(str(path))

    return read


def share(region: Region) -> float:
    """Of the sphere, from points, once by the region and once by its distances."""
    points = fibonacci_points(20000)
    inside = region.contains(points)
    np.testing.assert_array_equal(inside, region.distance(points) > 0.0)
    return float(inside.mean())


def share_of_box(width: float, south: float, north: float) -> float:
    return width / 360.0 * 0.5 * float(np.sin(np.radians(north)) - np.sin(np.radians(south)))


@pytest.mark.parametrize("kind", ["Polygon", "MultiPolygon", "Feature", "FeatureCollection"])
def test_a_polygon_with_a_hole(region: Any, kind: str) -> None:
    shape = polygon(box(-60, -10, 10, 60), box(-40, -30, 20, 30)[::-1])
    feature = {"type": "Feature", "properties": {}, "geometry": shape}
    content = {
        "Polygon": shape,
        "MultiPolygon": {"type": "MultiPolygon", "coordinates": [shape["coordinates"], [box(100, 110, 0, 10)]]},
        "Feature": feature,
        "FeatureCollection": {"type": "FeatureCollection", "features": [feature]},
    }[kind]
    found = region(content)
    assert found.contains(at((-20, 20), (-45, 25), (-30.0001, 19.999))).all()
    assert not found.contains(at((-35, 25), (-61, 20), (-20, 61), (35, 25))).any()
    assert bool(found.contains(at((105, 5)))[0]) == (kind == "MultiPolygon")
    more = share_of_box(10, 0, 10) if kind == "MultiPolygon" else 0.0
    exact = share_of_box(50, 10, 60) - share_of_box(10, 20, 30) + more
    assert np.isclose(share(found), exact, rtol=5e-3)
    assert np.isclose(np.degrees(found.distance(at((-35, 31)))[0]), 1.0, atol=1e-6)
    sea, island = found.coastline(np.radians(4.0))
    assert np.isclose(area_within([sea, island]), 4 * np.pi * (exact - more), rtol=4e-3)
    assert area_within([island]) < 0.0
    assert crossings([sea, island]) == 0
    assert len(found.coastline(np.radians(4.0), all_seas=True)) == (3 if kind == "MultiPolygon" else 2)


@pytest.mark.parametrize(
    "rings",
    [
        [box(170, 190, -10, 10)],
        [box(-190, -170, -10, 10)],
        [[[170, -10], [-170, -10], [-170, 10], [170, 10], [170, -10]]],
        [box(170, 180, -10, 10), box(-180, -170, -10, 10)],
    ],
    ids=["beyond 180", "beyond -180", "with a jump", "divided at the date line"],
)
def test_polygons_at_the_date_line_have_no_coast_there(region: Any, rings: list[Ring]) -> None:
    found = region({"type": "MultiPolygon", "coordinates": [[ring] for ring in rings]})
    assert found.contains(at((180, 0), (-180, 3), (179.99, 0), (-179.99, 0), (171, 9), (-171, -9))).all()
    assert not found.contains(at((169, 0), (-169, 0), (0, 0))).any()
    assert np.isclose(np.degrees(found.distance(at((180, 0)))[0]), np.degrees(np.arcsin(np.sin(np.radians(10)))))
    assert len(found.coastline(np.radians(1.0))) == 1
    assert np.isclose(share(found), share_of_box(20, -10, 10), rtol=0.02)


def test_a_polygon_round_a_pole_runs_along_it(region: Any) -> None:
    found = region(polygon([[-180, -90], [180, -90], [180, -60], [0, -60], [-180, -60], [-180, -90]]))
    assert found.contains(at((0, -90), (180, -75), (-180, -61), (50, -70))).all()
    assert np.isclose(np.degrees(found.distance(at((180, -80)))[0]), 20.0)
    assert np.isclose(share(found), share_of_box(360, -90, -60), rtol=5e-3)


def test_edges_are_straight_in_longitude_and_latitude(region: Any) -> None:
    found = region(polygon([[0, 50], [80, 50], [80, 70], [0, 70], [0, 50]]))
    assert found.contains(at((40, 50.001), (40, 69.999))).all()
    assert not found.contains(at((40, 49.999), (40, 70.001))).any()
    assert np.isclose(np.degrees(found.distance(at((40, 51)))[0]), 1.0, atol=1e-6)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (polygon([[0, 0], [10, 10], [10, 0], [0, 10], [0, 0]]), "polygon 0: is not simple (Self-intersection[5 5])"),
        (polygon([[-100, 0], [100, 0], [100, 50], [-100, 50], [-100, 0]]), "an edge from -100 to 100 degrees east"),
        (polygon([[0, 60], [170, 60], [-170, 60], [0, 60]]), "polygon 0: goes round a pole; give it edges along"),
        (polygon([[0, 0], [720, 0], [720, 10], [0, 10]]), "polygon 0: goes round the sphere more than once"),
        (polygon([[0, 0], [10, 0], [10, 100], [0, 0]]), "goes beyond longitudes of 720 or latitudes of 90 degrees"),
        (polygon([[0, 0], [10, 0]]), "a ring of 2 positions"),
        ({"type": "Polygon", "coordinates": [[["a", 0], [1, 2], [3, 4]]]}, "a ring is no list of positions"),
        ({"type": "Polygon"}, "a Polygon has no list of rings as its coordinates; give it one"),
        ({"type": "MultiPolygon", "coordinates": [[]]}, "a MultiPolygon has no list of rings"),
        ({"type": "LineString", "coordinates": [[0, 0], [1, 1]]}, "holds an object of the type 'LineString'"),
        ({"type": "FeatureCollection", "features": []}, "holds no polygon"),
        ([1, 2], "holds something that is no object of GeoJSON"),
        ('{"type": "Polygon", ', "is not GeoJSON (Expecting property name"),
        ("", "is not GeoJSON"),
    ],
)
def test_what_is_no_region_is_refused(region: Any, content: Any, words: str) -> None:
    with pytest.raises(MeshError) as error:
        region(content)
    message = str(error.value)
    assert words in message
    assert message.count("sea.geojson") == 1
    assert "\n" not in message


def test_a_missing_file_and_a_missing_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(MeshError, match=r"none.geojson: No such file or directory; give a GeoJSON file"):
        find_region(str(tmp_path / "none.geojson"))
    path = tmp_path / "sea.geojson"
    path.write_text(json.dumps(polygon(box(0, 10, 0, 10))))
    monkeypatch.setitem(__import__("sys").modules, "shapely", None)
    with pytest.raises(MeshError, match=r"a region bounded by polygons needs shapely, which is not installed; pip"):
        find_region(str(path))
