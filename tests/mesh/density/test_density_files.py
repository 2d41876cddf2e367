import warnings
from pathlib import Path

import numpy as np
import pytest
from density_files import EAST, NORTH, field, write_file

from mesh import MeshError, MeshWarning, scvt_mesh
from mesh.density.grid_interpolation import _smooth_grid
from mesh.density.gridded import Shaping, read_density
from mesh.density.named import Density
from mesh.geometry.sphere import fibonacci_points, from_lonlat, to_lonlat

LATITUDE, LONGITUDE = np.arange(-90.0, 91.0, 5.0), np.arange(0.0, 360.0, 5.0)
VALUES = field(LONGITUDE[None], LATITUDE[:, None])
POINTS = fibonacci_points(300)
RADIANS = {"units": "radians"}


@pytest.fixture
def plain(tmp_path: Path) -> np.ndarray:
    """Values at `POINTS` of the field on a grid whose file leaves nothing to guess."""
    path = write_file(
        tmp_path / "plain.nc",
        lat=(("lat",), LATITUDE, NORTH),
        lon=(("lon",), LONGITUDE, EAST),
        density=(("lat", "lon"), VALUES, {}),
    )
    return read_quietly(path)(POINTS)


def read_quietly(path: Path) -> Density:
    """Read a density; fails where something had to be assumed."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return read_density(path)


def test_the_grid_is_the_field(plain: np.ndarray) -> None:
    longitude, latitude = np.degrees(to_lonlat(POINTS))
    np.testing.assert_allclose(plain, field(longitude, latitude), atol=2.5e-3)


SHIFTED = np.arange(-180.0, 181.0, 5.0)
TWO = np.meshgrid(LONGITUDE, LATITUDE)
LEGAL = {
    "radians": (
        {"lat": (("lat",), np.radians(LATITUDE), RADIANS), "lon": (("lon",), np.radians(LONGITUDE), {"units": "rad"})},
        (("lat", "lon"), VALUES, {}),
    ),
    "mixed units": (
        {"lat": (("lat",), np.radians(LATITUDE), RADIANS), "lon": (("lon",), LONGITUDE, {"units": "degree"})},
        (("lat", "lon"), VALUES, {}),
    ),
    "north to south": (
        {"lat": (("lat",), LATITUDE[::-1], NORTH), "lon": (("lon",), LONGITUDE, EAST)},
        (("lat", "lon"), VALUES[::-1], {}),
    ),
    "repeated meridian from the date line": (
        {"lat": (("lat",), LATITUDE, NORTH), "lon": (("lon",), SHIFTED, EAST)},
        (("lat", "lon"), field(SHIFTED[None], LATITUDE[:, None]), {}),
    ),
    "longitude first": (
        {"lat": (("lat",), LATITUDE, NORTH), "lon": (("lon",), LONGITUDE, EAST)},
        (("lon", "lat"), VALUES.T, {}),
    ),
    "one time": (
        {"lat": (("lat",), LATITUDE, NORTH), "lon": (("lon",), LONGITUDE, EAST)},
        (("time", "lat", "lon"), VALUES[None], {}),
    ),
    "standard names": (
        {
            "a": (("a",), LATITUDE, {"standard_name": "latitude", "units": "degrees"}),
            "b": (("b",), LONGITUDE, {"standard_name": "longitude", "units": "degrees"}),
        },
        (("a", "b"), VALUES, {}),
    ),
    "axes": (
        {
            "j": (("j",), LATITUDE, {"axis": "Y", "units": "degrees"}),
            "i": (("i",), LONGITUDE, {"axis": "X", "units": "degrees"}),
        },
        (("j", "i"), VALUES, {}),
    ),
    "names of a model": (
        {
            "nav_lat": (("y", "x"), TWO[1], {"units": "degrees"}),
            "nav_lon": (("y", "x"), TWO[0], {"units": "degrees"}),
        },
        (("y", "x"), VALUES, {}),
    ),
    "capitals": (
        {"Latitude": (("n",), LATITUDE, {"units": "deg"}), "LONGITUDE": (("m",), LONGITUDE, {"units": "deg"})},
        (("n", "m"), VALUES, {}),
    ),
    "rotated coordinates beside the true ones": (
        {
            "rlat": (("rlat",), LATITUDE[::-1], {"standard_name": "grid_latitude", "units": "degrees"}),
            "rlon": (("rlon",), LONGITUDE, {"standard_name": "grid_longitude", "units": "degrees"}),
            "lat": (("rlat", "rlon"), TWO[1], {"standard_name": "latitude", **NORTH}),
            "lon": (("rlat", "rlon"), TWO[0], {"standard_name": "longitude", **EAST}),
        },
        (("rlat", "rlon"), VALUES, {"coordinates": "lon lat"}),
    ),
    "coordinates with a time": (
        {
            "XLAT": (("Time", "south_north", "west_east"), TWO[1][None], {"units": "degree_north"}),
            "XLONG": (("Time", "south_north", "west_east"), TWO[0][None], {"units": "degree_east"}),
        },
        (("Time", "south_north", "west_east"), VALUES[None], {}),
    ),
    "two points of a staggered grid": (
        {
            "ULAT": (("y", "x"), TWO[1] - 2.5, NORTH),
            "ULON": (("y", "x"), TWO[0] - 2.5, EAST),
            "TLAT": (("y", "x"), TWO[1], NORTH),
            "TLON": (("y", "x"), TWO[0], EAST),
        },
        (("y", "x"), VALUES, {"coordinates": "TLON TLAT"}),
    ),
}


@pytest.mark.parametrize("name", LEGAL)
def test_legal_variants_of_a_grid_are_one_density(name: str, tmp_path: Path, plain: np.ndarray) -> None:
    coordinates, density = LEGAL[name]
    path = write_file(tmp_path / "grid.nc", **coordinates, density=density)
    np.testing.assert_allclose(read_quietly(path)(POINTS), plain, rtol=1e-12)


@pytest.mark.parametrize(
    "names",
    [
        *(("lat", "lon"), ("LAT", "LON"), ("Latitude", "Longitude"), ("lats", "lons"), ("lat", "long"), ("y", "x")),
        *(("nav_lat", "nav_lon"), ("lat_0", "lon_0"), ("yc", "xc"), ("clat", "clon"), ("TLAT", "TLONG")),
        *(("gphit", "glamt"), ("geolat_t", "geolon_t"), ("XLAT", "XLONG"), ("lat_rho", "lon_rho")),
    ],
)
def test_names_in_common_use_are_known(names: tuple[str, str], tmp_path: Path, plain: np.ndarray) -> None:
    latitude, longitude = names
    angles = {latitude: (("j",), LATITUDE, {"units": "degrees"}), longitude: (("i",), LONGITUDE, {"units": "degrees"})}
    path = write_file(tmp_path / "grid.nc", **angles, density=(("j", "i"), VALUES, {}))
    np.testing.assert_allclose(read_quietly(path)(POINTS), plain, rtol=1e-12)


def test_packed_values_are_unpacked(tmp_path: Path, plain: np.ndarray) -> None:
    packed = (("lat", "lon"), VALUES, {"scale_factor": 1e-3, "add_offset": 2.0})
    lat = (("lat",), LATITUDE, {"scale_factor": 0.5, "add_offset": 10.0, **NORTH})
    path = write_file(tmp_path / "grid.nc", lat=lat, lon=(("lon",), LONGITUDE, EAST), density=packed)
    np.testing.assert_allclose(read_quietly(path)(POINTS), plain, atol=5.1e-4)


ASSUMED = {
    "no units, degrees": ("lat", LATITUDE, LONGITUDE, {}, "lat and lon without units, taken to be in degrees"),
    "no units, radians": (
        "lat",
        np.radians(LATITUDE),
        np.radians(LONGITUDE),
        {},
        "lat and lon without units, taken to be in radians",
    ),
    "co-latitude": (
        "colatitude",
        90.0 - LATITUDE,
        LONGITUDE,
        {"units": "degrees"},
        "colatitude is taken to be co-latitude, counted from the north pole",
    ),
    "co-latitude in radians": (
        "colat",
        np.radians(90.0 - LATITUDE),
        np.radians(LONGITUDE),
        {"units": "radians"},
        "colat is taken to be co-latitude",
    ),
}


@pytest.mark.parametrize("name", ASSUMED)
def test_what_is_assumed_is_said(name: str, tmp_path: Path, plain: np.ndarray) -> None:
    latitude_name, latitude, longitude, units, words = ASSUMED[name]
    coordinates = {latitude_name: (("n",), latitude, units), "lon": (("m",), longitude, units)}
    path = write_file(tmp_path / "grid.nc", **coordinates, density=(("n", "m"), VALUES, {}))
    with pytest.warns(MeshWarning, match=words) as told:
        density = read_density(path)
    assert len(told) == 1
    np.testing.assert_allclose(density(POINTS), plain, rtol=1e-12)


REFUSED = {
    "latitudes beyond the poles": (
        "lat",
        LATITUDE + 90.0,
        LONGITUDE,
        NORTH,
        "lat goes from 0 to 180 degrees, which are",
    ),
    "degrees that say radians": ("lat", LATITUDE, LONGITUDE, RADIANS, "lat goes from -5156.62 to 5156.62 degrees"),
    "metres that say degrees": ("lat", LATITUDE, 1e5 * LONGITUDE, {"units": "degrees"}, "which are not longitudes"),
    "kilometres": (
        "lat",
        LATITUDE,
        LONGITUDE,
        {"units": "km", "standard_name": "latitude"},
        "lat has the unit km; give it in degrees or radians",
    ),
    "metres": ("lat", LATITUDE, LONGITUDE, {"units": "m"}, "no latitude and longitude is found along them"),
    "gaps in coordinates": ("lat", np.ma.masked_greater(LATITUDE, 80), LONGITUDE, NORTH, "2 of 37 values of lat"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_no_coordinates_are_refused(name: str, tmp_path: Path) -> None:
    latitude_name, latitude, longitude, units, words = REFUSED[name]
    east = units if units in (RADIANS, {"units": "degrees"}, {"units": "m"}) else EAST
    coordinates = {latitude_name: (("n",), latitude, units), "lon": (("m",), longitude, east)}
    path = write_file(tmp_path / "grid.nc", **coordinates, density=(("n", "m"), VALUES, {}))
    with pytest.raises(MeshError, match=words):
        read_density(path)


def test_several_times_are_refused(tmp_path: Path) -> None:
    path = write_file(
        tmp_path / "grid.nc",
        lat=(("lat",), LATITUDE, NORTH),
        lon=(("lon",), LONGITUDE, EAST),
        density=(("time", "lat", "lon"), np.stack([VALUES] * 3), {}),
    )
    with pytest.raises(MeshError, match="density has 3 entries along time; write the one that is wanted to a file"):
        read_density(path)


@pytest.mark.slow
def test_degrees_and_radians_give_one_mesh(tmp_path: Path) -> None:
    """Cell widths that differ by a factor of four, as they come from a program that writes widths on a grid."""
    width = 75.0 - 45.0 * np.tanh((field(LONGITUDE[None], LATITUDE[:, None]) - 2.0) / 0.3)
    meshes = []
    for unit, factor in (("degrees", 1.0), ("radians", np.pi / 180.0)):
        path = write_file(
            tmp_path / f"{unit}.nc",
            lat=(("lat",), factor * LATITUDE, {"units": unit}),
            lon=(("lon",), factor * LONGITUDE, {"units": unit}),
            cellWidth=(("lat", "lon"), width, {"units": "km"}),
        )
        meshes.append(scvt_mesh(300, density=read_density(path, "cellWidth", Shaping(power=-4.0)), tolerance=1e-4))
    degrees, radians = meshes
    np.testing.assert_allclose(radians.cell_points, degrees.cell_points, atol=1e-9)
    assert degrees.area_cell.max() / degrees.area_cell.min() == pytest.approx((120.0 / 30.0) ** 2, rel=0.4)


def test_part_of_the_globe_takes_the_nearest_value_beyond(tmp_path: Path) -> None:
    """A sea from 340 to 40 degrees east, across the prime meridian, and from 10 to 60 degrees north."""
    longitude, latitude = np.arange(-20.0, 41.0, 2.0) % 360.0, np.arange(10.0, 61.0, 2.0)
    value = 1.0 + (longitude[None] + 20.0) % 360.0 / 60.0 + 0.0 * latitude[:, None]
    path = write_file(
        tmp_path / "grid.nc",
        lat=(("lat",), latitude, NORTH),
        lon=(("lon",), longitude, EAST),
        density=(("lat", "lon"), value, {}),
    )
    with pytest.warns(
        MeshWarning, match="density covers a part of the globe only; beyond it the nearest value"
    ) as told:
        density = read_density(path)
    assert len(told) == 1

    def at(*places: tuple[float, float]) -> np.ndarray:
        lon, lat = np.radians(np.array(places)).T
        return density(from_lonlat(lon, lat))

    np.testing.assert_allclose(at((-20, 30), (10, 30), (40, 30), (0, 59)), [1.0, 1.5, 2.0, 4.0 / 3.0], rtol=1e-9)
    np.testing.assert_allclose(at((100, 30), (130, 30), (-60, 30), (10, -40), (10, 75)), [2, 2, 1, 1.5, 1.5], rtol=1e-9)
    around = at(*((lon, 30.0) for lon in np.arange(0.0, 360.0, 0.1)))
    assert np.abs(np.diff(around, append=around[0])).max() < 0.01
    assert scvt_mesh(200, density=density).n_cells == 200


def test_values_at_the_pole_are_one(tmp_path: Path) -> None:
    """Rows between the poles leave a gap of half a row, in which values blend to the mean of the last one."""
    latitude = np.arange(-87.5, 90.0, 5.0)
    value = 2.0 + np.cos(np.radians(LONGITUDE))[None] + 0.0 * latitude[:, None]
    path = write_file(
        tmp_path / "grid.nc",
        lat=(("lat",), latitude, NORTH),
        lon=(("lon",), LONGITUDE, EAST),
        density=(("lat", "lon"), value, {}),
    )
    density = read_quietly(path)
    near = from_lonlat(np.radians(LONGITUDE), np.full(72, np.radians(89.999)))
    np.testing.assert_allclose(density(near), 2.0, atol=1e-3)
    assert scvt_mesh(200, density=density).n_cells == 200


def test_curvilinear_grid_is_interpolated(tmp_path: Path) -> None:
    """A grid of latitude and longitude that is turned away from the pole, the seam written twice."""
    turn = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(0.5), -np.sin(0.5)], [0.0, np.sin(0.5), np.cos(0.5)]])
    east, north = np.meshgrid(np.radians(np.arange(0.0, 361.0, 5.0)), np.radians(LATITUDE))
    longitude, latitude = np.degrees(to_lonlat(from_lonlat(east, north) @ turn.T))
    path = write_file(
        tmp_path / "grid.nc",
        lat=(("y", "x"), latitude, NORTH),
        lon=(("x", "y"), longitude.T, EAST),
        density=(("x", "y"), field(longitude, latitude).T, {}),
    )
    density = read_quietly(path)
    expected = field(*np.degrees(to_lonlat(POINTS)))
    np.testing.assert_allclose(density(POINTS), expected, atol=4e-3)


def test_curvilinear_sea_takes_the_nearest_value_beyond(tmp_path: Path) -> None:
    east, north = np.meshgrid(np.arange(-20.0, 21.0, 2.0), np.arange(30.0, 61.0, 2.0))
    path = write_file(
        tmp_path / "grid.nc",
        lat=(("y", "x"), north, NORTH),
        lon=(("y", "x"), east + 0.1 * north, EAST),
        density=(("y", "x"), north / 30.0, {}),
    )
    with pytest.warns(MeshWarning, match="covers a part of the globe only"):
        density = read_density(path)
    lon, lat = np.radians([[0.0, 2.0, 0.0, 180.0], [31.0, 59.0, -40.0, -80.0]])
    np.testing.assert_allclose(density(from_lonlat(lon, lat)), [31 / 30, 59 / 30, 1.0, 1.0], atol=0.03)


@pytest.mark.parametrize("radius", [1.0, 6371220.0])
def test_density_on_cells_may_be_in_any_coordinates(radius: float, tmp_path: Path) -> None:
    centers = fibonacci_points(200)
    lon, lat = to_lonlat(centers)
    values = field(*np.degrees((lon, lat)))
    cartesian = {f"{axis}Cell": (("nCells",), radius * centers[:, k], {}) for k, axis in enumerate("xyz")}
    spherical = {"latCell": (("nCells",), lat, {"units": "rad"}), "lonCell": (("nCells",), lon, {"units": "rad"})}
    found = []
    for name, coordinates in (("a.nc", cartesian), ("b.nc", spherical)):
        path = write_file(tmp_path / name, **coordinates, density=(("Time", "nCells"), values[None], {}))
        density = read_quietly(path)
        found.append(density(POINTS))
    np.testing.assert_array_equal(read_quietly(tmp_path / "a.nc")(centers)[:1], values[:1])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)


@pytest.mark.parametrize(
    ("values", "shaping", "words"),
    [
        (0.0 * VALUES, Shaping(), "density is zero everywhere"),
        (
            np.where(VALUES > 1.0, VALUES, 0.0),
            Shaping(power=-4.0),
            "field goes from 0 to .* has no finite power -4",
        ),
        (VALUES[:1], Shaping(), "density has one latitude; a grid needs at least two"),
    ],
)
def test_fields_that_give_no_density_are_refused(
    values: np.ndarray, shaping: Shaping, words: str, tmp_path: Path
) -> None:
    path = write_file(
        tmp_path / "grid.nc",
        lat=(("lat",), LATITUDE[: len(values)], NORTH),
        lon=(("lon",), LONGITUDE, EAST),
        density=(("lat", "lon"), values, {}),
    )
    with pytest.raises(MeshError, match=words):
        read_density(path, shaping=shaping)


def test_coordinates_of_one_and_two_dimensions_are_refused(tmp_path: Path) -> None:
    path = write_file(
        tmp_path / "grid.nc",
        lat=(("y", "x"), TWO[1], NORTH),
        lon=(("x",), LONGITUDE, EAST),
        density=(("y", "x"), VALUES, {}),
    )
    with pytest.raises(MeshError, match=r"lat has dimensions \('y', 'x'\) and lon has \('x',\); both must have one"):
        read_density(path)


def test_smoothing_is_a_mean_with_neighbours_and_ends_at_edges() -> None:
    """A spike on a grid of the globe spreads over the meridian; beside the edge of a part of it, onto the edge."""
    values = np.zeros((3, 4))
    values[1, 0] = 8.0
    expected = np.array([[1.0, 0.0, 0.0, 0.0], [4.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(_smooth_grid(values, "wrap"), expected)
    expected[1] = [5.0, 1.0, 0.0, 0.0]
    np.testing.assert_array_equal(_smooth_grid(values, "edge"), expected)


def test_a_part_of_the_globe_is_smoothed_within_itself(tmp_path: Path) -> None:
    """The western edge keeps out what stands at the eastern one."""
    latitude, longitude = np.linspace(-20.0, 20.0, 9), np.linspace(10.0, 50.0, 9)
    values = np.ones((9, 9))
    values[:, -1] = 5.0
    path = write_file(
        tmp_path / "part.nc",
        lat=(("lat",), latitude, NORTH),
        lon=(("lon",), longitude, EAST),
        density=(("lat", "lon"), values, {}),
    )
    with pytest.warns(MeshWarning):
        density = read_density(path, shaping=Shaping(smoothing=1))
    points = from_lonlat(np.radians([10.0, 50.0, 45.0]), np.zeros(3))
    np.testing.assert_allclose(density(points), [1.0, 4.5, 1.5], rtol=1e-10)
