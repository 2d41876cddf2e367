"""Coasts for tests: wavy circles on the sphere, and the cells of generators within them."""

import numpy as np

from mesh.arrays import Array
from mesh.coast.coastline import Coastline
from mesh.coast.generation import converge_at_sea
from mesh.coast.sea_cells import SeaCells, SeaResult
from mesh.coast.start import fillers, sea_spacing, starting_points
from mesh.density.named import Density, uniform
from mesh.generation.optimizer import Limits
from mesh.geometry.sphere import east_north, from_lonlat

CENTER = (np.radians(30.0), np.radians(40.0))
POLE = from_lonlat(np.array(CENTER[0]), np.array(CENTER[1]))
RADIUS = 0.5


def wavy_ring(
    count: int,
    center: tuple[float, float] = CENTER,
    radius: float = RADIUS,
    amplitude: float = 0.15,
    waves: int = 3,
    sea_within: bool = True,
) -> Array:
    """A closed ring (count, 3) round a centre (longitude, latitude), with the sea to its left."""
    longitude, latitude = np.array(center[0]), np.array(center[1])
    pole, (east, north) = from_lonlat(longitude, latitude), east_north(longitude, latitude)
    angle = np.arange(count) * (2.0 * np.pi / count) * (1.0 if sea_within else -1.0)
    distance = (radius * (1.0 + amplitude * np.cos(waves * angle + 0.4)))[:, None]
    around = np.cos(angle)[:, None] * east + np.sin(angle)[:, None] * north
    return np.cos(distance) * pole + np.sin(distance) * around


def wavy_sea(cells: int, island: bool = True) -> Coastline:
    """A wavy sea, with an island if asked for, and a coast as fine as so many cells need."""
    spacing = RADIUS * np.sqrt(2.0 * np.pi / (np.sqrt(3.0) * cells))
    rings = [wavy_ring(int(8.0 * np.pi * RADIUS / spacing))]
    if island:
        center = (np.radians(20.0), np.radians(45.0))
        rings.append(wavy_ring(int(8.0 * np.pi * 0.12 / spacing), center, 0.12, 0.2, 2, sea_within=False))
    return Coastline(rings)


def cells_of_sea(coastline: Coastline, cells: int, start: str = "random") -> tuple[Array, SeaCells]:
    """Generators (cells, 3) that have not moved yet, and their clipped cells."""
    points = starting_points(coastline, cells, start=start)
    return points, SeaCells(points, coastline, fillers(coastline, sea_spacing(coastline, cells)))


def converged(
    coastline: Coastline, cells: int, tolerance: float = 1e-6, method: str = "lbfgs", density: Density = uniform
) -> SeaResult:
    """Generators at the centroids of their clipped cells."""
    points = starting_points(coastline, cells, density, "fibonacci" if density is uniform else "random-root")
    return converge_at_sea(coastline, points, method, density, Limits(tolerance))
