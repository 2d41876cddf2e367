"""Regions from fields on grids: masks, signed distances, parts of the globe, poles, and bad files."""

from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from mesh import MeshError
from mesh.arrays import Array
from mesh.geometry.sphere import arc_length, fibonacci_points, from_lonlat
from mesh.regions.find import find_region
from tests.mesh.regions.rings import area_within, crossings


def at(*places: tuple[float, float]) -> Array:
    """Unit vectors at degrees east and north."""
    return from_lonlat(*np.radians(places).T)


def write(path: Path, longitude: Array, latitude: Array, values: Array, **attributes: Any) -> str:
    """A file with one field (latitude, longitude); the region's name."""
    with netCDF4.Dataset(path, "w") as file:
        for name, axis, unit in (("lat", latitude, "degrees_north"), ("lon", longitude, "degrees_east")):
            file.createDimension(name, len(axis))
            file.createVariable(name, "f8", (name,))[:] = axis
            file[name].units = unit
        file.createDimension("time", 1)
        field = file.createVariable("sea", values.dtype, ("time", "lat", "lon"))
        field[:] = values[None]
        field.setncatts(attributes)
    return f"{path}:sea"


LONGITUDE, LATITUDE = np.arange(0.5, 360.0), np.arange(-89.5, 90.0)
CAP = at((178, 20))
"""Centre of a cap, over the date line, with a radius of 30 degrees."""


def cap_distance() -> Array:
    east, north = np.meshgrid(LONGITUDE, LATITUDE)
    return 30.0 - np.degrees(arc_length(from_lonlat(np.radians(east), np.radians(north)), CAP[0]))


@pytest.mark.parametrize("kind", ["distance", "mask", "land", "packed the other way"])
def test_a_cap_over_the_date_line(tmp_path: Path, kind: str) -> None:
    distance = cap_distance()
    attributes = {"standard_name": "land_binary_mask"} if kind == "land" else {}
    values = {
        "distance": 1e5 * distance,
        "mask": (distance > 0.0).astype("i1"),
        "land": (distance <= 0.0).astype("i1"),
        "packed the other way": distance[::-1],
    }[kind]
    latitude = LATITUDE[::-1] if kind == "packed the other way" else LATITUDE
    region = find_region(write(tmp_path / "cap.nc", LONGITUDE, latitude, values, **attributes))
    points = fibonacci_points(5000)
    expected = np.radians(30.0) - arc_length(points, CAP[0])
    clear = np.abs(expected) > np.radians(0.8)
    np.testing.assert_array_equal(region.contains(points)[clear], (expected > 0.0)[clear])
    rough = np.radians(0.8 if kind in ("mask", "land") else 0.05)
    near = expected > -np.pi / 2
    np.testing.assert_allclose(region.distance(points)[near], expected[near], atol=rough)
    (ring,) = region.coastline(np.radians(3.0))
    assert np.isclose(area_within([ring]), 2 * np.pi * (1 - np.cos(np.radians(30))), rtol=0.01)
    assert crossings([ring]) == 0


def test_a_grid_of_a_part_is_all_that_is_not_land(tmp_path: Path) -> None:
    name = write(tmp_path / "part.nc", np.arange(-20.0, 21.0), np.arange(0.0, 31.0), np.ones((31, 41), "i4"))
    region = find_region(name)
    assert region.contains(at((-20, 0), (20, 30), (0, 15), (340, 10))).all()
    assert not region.contains(at((-20.01, 10), (20.01, 10), (0, 30.01), (0, -0.01), (180, 10))).any()
    assert np.isclose(np.degrees(region.distance(at((0, 29)))[0]), 1.0, atol=1e-5)


def test_poles_and_greenwich_are_no_coasts(tmp_path: Path) -> None:
    region = find_region(write(tmp_path / "mask.nc", LONGITUDE, LATITUDE, np.ones((180, 360))))
    assert region.contains(np.concatenate([fibonacci_points(500), at((0, 90), (0, -90), (0, 0), (359.9, 5))])).all()
    assert region.coastline(0.05) == []


def test_bad_files_are_refused_in_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "cap.nc"
    name = write(path, LONGITUDE, LATITUDE, cap_distance())
    with pytest.raises(MeshError, match=r"cap.nc: there is no variable named land; name one .* lat, lon, sea"):
        find_region(f"{path}:land")
    with pytest.raises(MeshError, match=r"none.nc: there is no such file; give a NetCDF file with a mask"):
        find_region(f"{tmp_path / 'none.nc'}:sea")
    with pytest.raises(MeshError, match=r"lat has dimensions \('lat',\)|no longitude is found"):
        find_region(f"{path}:lat")
    with netCDF4.Dataset(path, "a") as file:
        file["sea"][0, 3, 4] = np.nan
    with pytest.raises(MeshError, match=r"1 of 64800 values of sea are missing or not finite, .*; fill them"):
        find_region(name)
    path.write_bytes(b"no NetCDF file")
    with pytest.raises(MeshError, match=r"cap.nc: sea cannot be read \(.*\); give a mask on a grid"):
        find_region(name)


def test_a_region_without_sea_has_no_coastline(tmp_path: Path) -> None:
    region = find_region(write(tmp_path / "land.nc", LONGITUDE, LATITUDE, np.zeros((180, 360))))
    assert not region.contains(fibonacci_points(500)).any()
    with pytest.raises(MeshError, match="no sea is as wide as the spacing"):
        region.coastline(0.05)
