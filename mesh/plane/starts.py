"""Points to start from in a rectangle."""

import math

import numpy as np

from mesh.arrays import Array
from mesh.density.named import Density, density_at, uniform
from mesh.errors import MeshError
from mesh.generation.generators import DENSITY_MARGIN, drawn_by_rejection
from mesh.mesh_request import MeshRequest
from mesh.plane.domain import Rectangle
from mesh.triangulation.ordering import hilbert_order

STARTS = ("rows", "random", "random-root")

PROBES = 20_000
"""Points at which the largest value of a density is sought."""

FEWEST_PERIODIC, FEWEST_IN_BOX = 12, 3
"""Cells of planes that repeat themselves, whose triangles must be shorter than half a period, and of others."""


def starting_points(
    plane: Rectangle,
    cells: int,
    density: Density = uniform,
    start: str | None = None,
    seed: int = MeshRequest.seed,
) -> Array:
    """Points (cells, 3) in the plane, numbered along a space-filling curve.

    `start` is `rows`, the default under uniform density: rows of cells in turn, as near to hexagons as the rectangle
    allows; `random`, drawn from the density; or `random-root`, drawn from its square root, which converges sooner, the
    default under another density. Raises `MeshError` for too few cells, an unknown start, or a density that is negative
    or zero everywhere.
    """
    start = named_start(start, cells, FEWEST_PERIODIC if any(plane.repeats) else FEWEST_IN_BOX, density)
    if start == "rows":
        points = rows_of_points(plane, cells)
    else:
        points = random_points(plane, cells, density, 1.0 if start == "random" else 0.5, seed)
    return np.ascontiguousarray(points[hilbert_order(plane.surface.curve_places(points))])


def named_start(start: str | None, cells: int, fewest: int, density: Density) -> str:
    """The name of the start, that of the default if it is None; raises `MeshError` as `starting_points` does."""
    if cells < fewest:
        raise MeshError(f"a mesh of {cells} cells is too small; ask for at least {fewest}")
    start = start or ("rows" if density is uniform else "random-root")
    if start not in STARTS:
        raise MeshError(f"a mesh on a plane cannot start from '{start}'; choose one of {', '.join(STARTS)}")
    return start


def rows_of_points(plane: Rectangle, cells: int) -> Array:
    """Points (cells, 3) in rows along x, as many in each as equally as can be, every other row half a step aside."""
    n_rows = max(1, round(math.sqrt(2.0 * cells * plane.height / (math.sqrt(3.0) * plane.width))))
    if plane.repeats[1]:
        n_rows += n_rows % 2
    ends = np.arange(n_rows + 1) * cells // n_rows
    row = np.repeat(np.arange(n_rows), np.diff(ends))
    place = np.arange(cells) - ends[row]
    x = (place + 0.25 + 0.5 * (row % 2)) * plane.width / np.diff(ends)[row]
    return np.column_stack([x, (row + 0.5) * plane.height / n_rows, np.zeros(cells)])


def random_points(plane: Rectangle, count: int, density: Density, power: float, seed: int) -> Array:
    """Points (count, 3) drawn from a power of the density by rejection."""
    generator = np.random.default_rng(seed)

    def weight(points: Array) -> Array:
        return density_at(density, points, plane.surface) ** power

    bound = 1.0
    if density is not uniform:
        bound = DENSITY_MARGIN * float(weight(rows_of_points(plane, PROBES)).max())
        if not bound > 0.0:
            raise MeshError("the density is zero everywhere it was tried; give one that is positive")

    def propose(size: int) -> Array:
        return np.column_stack([generator.uniform(0.0, plane.lengths, (size, 2)), np.zeros(size)])

    return drawn_by_rejection(count, propose, weight, bound, generator, 1.0)
