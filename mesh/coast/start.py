"""Points to start from: generators in the sea, and fillers on land."""

import numpy as np

from mesh.arrays import Array
from mesh.coast.coastline import Coast, Coastline
from mesh.density.named import Density, density_at, uniform
from mesh.density.scaling import PROBES
from mesh.density.spreading import ZERO_DENSITY, spread_points
from mesh.errors import MeshError
from mesh.generation.generators import DEFAULT_SEED, random_points
from mesh.geometry.sphere import fibonacci_points
from mesh.triangulation.ordering import hilbert_order

FEWEST_CELLS = 12

FILLERS = 1000
"""Fillers on a sphere without sea: so many that cells at the coast stay well below a hemisphere."""

INLAND = 3.0
"""Distance of fillers from the coast, in spacings: beyond the generators of the coast, seen from the sea."""


def sea_spacing(coastline: Coast, cells: int) -> float:
    """Distance (radians) between neighbours if `cells` equal plane hexagons filled the sea."""
    return float(np.sqrt(2.0 * coastline.area / (np.sqrt(3.0) * cells)))


def fillers(coastline: Coastline, spacing: float) -> Array:
    """Points (k, 3) on land that surround the sphere together with the generators, far from the coast."""
    points = fibonacci_points(FILLERS)
    return points[coastline.distance(points) < -INLAND * spacing]


def starting_points(
    coastline: Coastline, cells: int, density: Density = uniform, start: str | None = None, seed: int = DEFAULT_SEED
) -> Array:
    """Points (cells, 3) in the sea, along a space-filling curve: on the Fibonacci spiral, or as the density asks.

    `start` is `fibonacci`, `random` (drawn from the density) or `random-root` (from its square root, which converges
    sooner). By default it is the first under uniform density; under another one points are spread evenly as its square
    root asks, which takes no drawing at all. Raises `MeshError` for fewer than 12 cells, an unknown start, or a density
    that is zero at sea.
    """
    if cells < FEWEST_CELLS:
        raise MeshError(f"a mesh of {cells} cells is too small; ask for at least {FEWEST_CELLS}")
    if start is None and density is not uniform:
        points = spread_points(cells, lambda points: np.sqrt(density_at(density, points)), coastline.distance, seed)
    elif start in (None, "fibonacci"):
        points = _spiral(coastline, cells)
    elif start in ("random", "random-root"):
        points = _drawn(coastline, cells, density, 1.0 if start == "random" else 0.5, seed)
    else:
        raise MeshError(f"a mesh with a coast cannot start from '{start}'; choose fibonacci, random or random-root")
    return np.ascontiguousarray(points[hilbert_order(points)])


def _spiral(coastline: Coastline, cells: int) -> Array:
    """Points of a Fibonacci spiral in the sea; those that are too many are left out where the coast is nearest."""
    count = int(cells * 4.0 * np.pi / coastline.area)
    while True:
        points = fibonacci_points(count)
        distance = coastline.distance(points)
        sea = np.flatnonzero(distance > 0.0)
        if len(sea) >= cells:
            return points[np.sort(sea[np.argsort(-distance[sea], kind="stable")[:cells]])]
        count += max(1, int((cells - len(sea)) * 4.0 * np.pi / coastline.area))


def _drawn(coastline: Coastline, cells: int, density: Density, power: float, seed: int) -> Array:
    """Points drawn from a power of the density in the sea."""
    generator = np.random.default_rng(seed)

    def at_sea(points: Array) -> Array:
        values = density_at(density, points) ** power
        return np.where(coastline.contains(points), values, 0.0)

    probes = fibonacci_points(PROBES)
    probes = probes[coastline.contains(probes)]
    if len(probes) and not at_sea(probes).any():
        raise MeshError(ZERO_DENSITY)
    return random_points(cells, at_sea, generator)
