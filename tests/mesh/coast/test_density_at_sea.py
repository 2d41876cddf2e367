"""Densities that are zero or missing at sea, or on land alone, and coasts finer than the spacing."""

import json
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh
from mesh.coast.generation import region_mesh
from mesh.density.gridded import read_density
from mesh.discrete.walls import wall_edges
from mesh.mesh_request import MeshRequest
from mesh.regions.find import find_region

BOX = "300,340,20,50"


def filled_under(path: Path, at_sea: float, on_land: float) -> VoronoiMesh:
    """The box filled under a density from a file that is `at_sea` and `on_land`; it is so two degrees beyond it."""
    latitude, longitude = np.arange(-89.5, 90.0), np.arange(0.5, 360.0)
    east, north = np.meshgrid(longitude, latitude)
    sea = (east > 298.0) & (east < 342.0) & (north > 18.0) & (north < 52.0)
    with netCDF4.Dataset(path, "w") as file:
        for name, places, unit in (("lat", latitude, "degrees_north"), ("lon", longitude, "degrees_east")):
            file.createDimension(name, len(places))
            file.createVariable(name, "f8", (name,)).units = unit
            file[name][:] = places
        file.createVariable("density", "f8", ("lat", "lon"))[:] = np.where(sea, at_sea, on_land)
    return region_mesh(find_region(BOX), MeshRequest(cells=150, density=read_density(path), tolerance=1e-4))


def test_a_density_may_be_zero_on_land(tmp_path: Path) -> None:
    mesh = filled_under(tmp_path / "density.nc", 1.0, 0.0)
    assert mesh.n_cells == 150
    np.testing.assert_array_equal(mesh.mesh_density, 1.0)
    assert mesh.area_cell.max() < 1.5 * mesh.area_cell.min()


def test_a_density_that_is_zero_all_over_the_sea_is_told(tmp_path: Path) -> None:
    with pytest.raises(
        MeshError, match=r"^the density is zero wherever it was tried at sea; give one that is positive"
    ):
        filled_under(tmp_path / "density.nc", 0.0, 1.0)


def test_a_cell_at_sea_without_density_is_told() -> None:
    def density(points: np.ndarray) -> np.ndarray:
        return np.where(points[:, 2] > 0.6, 0.0, 1.0)

    with pytest.raises(
        MeshError,
        match=r"^the density is zero on the whole cell at longitude -?\d+\.\d+ and latitude \d+\.\d+ degrees; give it "
        "a floor above zero$",
    ):
        region_mesh(find_region(BOX), MeshRequest(cells=150, density=density, start="fibonacci"))


@pytest.mark.parametrize(("at_sea", "on_land", "row", "column"), [(np.nan, 1.0, 108, 298), (1.0, np.nan, 0, 0)])
def test_missing_densities_are_told_with_their_place(
    tmp_path: Path, at_sea: float, on_land: float, row: int, column: int
) -> None:
    words = (
        rf"density\.nc: \d+ of 64800 values of density are missing or not finite, the first at lat={row}, "
        rf"lon={column}, counted from 0; fill them, those on land too$"
    )
    with pytest.raises(MeshError, match=words):
        filled_under(tmp_path / "density.nc", at_sea, on_land)


def test_a_function_that_is_not_finite_at_sea_is_told_with_its_place() -> None:
    def density(points: np.ndarray) -> np.ndarray:
        return np.where(points[:, 2] > 0.6, np.nan, 1.0)

    with pytest.raises(
        MeshError, match=r"^the density is nan at longitude -?\d+\.\d+ and latitude \d+\.\d+ degrees; it"
    ):
        region_mesh(find_region(BOX), MeshRequest(cells=150, density=density))


def test_teeth_and_islands_finer_than_the_spacing_make_the_mesh_of_a_smooth_sea(tmp_path: Path) -> None:
    """Teeth of a fifth of a spacing along the southern coast, and an island of one cell's size at most."""
    west = np.arange(300.0, 340.0)
    south = [point for x in west for point in ([x, 20.0], [x + 0.5, 20.5])]
    ring = [*south, [340.0, 20.0], [340.0, 50.0], [300.0, 50.0], [300.0, 20.0]]
    island = [[320.0, 35.0], [320.0, 36.5], [321.5, 36.5], [321.5, 35.0], [320.0, 35.0]]
    file = tmp_path / "teeth.geojson"
    polygon = {"type": "Polygon", "coordinates": [ring, island]}
    file.write_text(json.dumps(polygon))
    mesh = region_mesh(find_region(str(file)), MeshRequest(cells=150, tolerance=1e-4))
    assert mesh.n_cells == 150
    assert mesh.area_cell.max() < 1.5 * mesh.area_cell.min()
    # One coast, that of the box: as many walls as vertices of it, and no ring round the island.
    walls = wall_edges(mesh)
    assert find_region(BOX).distance(mesh.edge_points[walls]).max() < np.radians(3.0)
