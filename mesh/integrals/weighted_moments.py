"""Masses, moments, energy and gradient of Voronoi cells under a density.

A cell is the union of the spherical triangles (x, c, c') of its generator x and successive corners c, c'. With
u = c - x, v = c' - x and p = x + s u + t v a point of the flat triangle, y = p / |p| lies on the sphere, and its
element of area is x.(u x v) / |p|^3 ds dt exactly. A symmetric quadrature rule of order five on the flat triangle
(Dunavant 1985) gives

    mass    m = sum of weight * density(y),
    moment  M = sum of weight * density(y) * y,
    energy  E = sum of weight * density(y) * |y - x|^2.

Where a triangle lies outside of the cell, a corner being beyond another side, its area is negative, as it should be.
Tangential parts and |y - x|^2 come from q = s u + t v, which is small, so that nothing cancels.

The quadrature points of a chunk of cells are written by one kernel, the density, any callable, is applied to them, and
a second kernel sums. Cells on a plateau of the density (`mesh.density.plateaus`) have the exact integrals of
`mesh.integrals.moments` instead, times its value; since |y - x|^2 = 2 - 2 x.y, their mass is x.M + E / 2.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.density.named import Density, density_at
from mesh.density.plateaus import Plateaus, plateaus_of
from mesh.density.scaling import within_range
from mesh.errors import MeshError
from mesh.geometry.cube import patch_of
from mesh.geometry.surface import UNIT_SPHERE, Surface
from mesh.geometry.vectors import dot_product, outward, triple_product, vector_between, vector_to
from mesh.integrals.moments import BLOCK, cell_moment

CHUNK = 16384
"""Cells whose quadrature points are held at a time."""


def _orbit(weight: float, twice: float) -> list[tuple[float, float, float]]:
    """Rows (s, t, weight) of the three points with two barycentric coordinates equal to `twice`."""
    once = 1.0 - 2.0 * twice
    return [(twice, twice, 0.5 * weight), (once, twice, 0.5 * weight), (twice, once, 0.5 * weight)]


RULE = np.array(
    [
        (1 / 3, 1 / 3, 0.5 * 0.225),
        *_orbit((155 + np.sqrt(15)) / 1200, (6 + np.sqrt(15)) / 21),
        *_orbit((155 - np.sqrt(15)) / 1200, (6 - np.sqrt(15)) / 21),
    ]
)
"""Seven points of order five, exact for polynomials of degree five on the triangle s, t >= 0, s + t <= 1."""


@numba.njit(parallel=True, cache=True)
def _integrate_on_plateaus(
    points: Array,
    circumcenters: Array,
    ring_starts: Index,
    rings: Index,
    resolution: int,
    values: Array,
    reaches: Array,
    sums: Array,
    nodes: Index,
) -> None:
    """Write the integrals of cells on `Plateaus` to `sums`, as `_sum_cells` does, and to `nodes` what the others need.

    That is a number of quadrature points (n,), zero for cells on a plateau.
    """
    for cell in numba.prange(len(points)):
        x, y, z = vector_to(points, cell)
        patch = patch_of(x, y, z, resolution)
        reach = reaches[patch]
        square = reach * reach if reach > 0.0 else 0.0
        start, stop = ring_starts[cell], ring_starts[cell + 1]
        inside = True
        for slot in range(start, stop):
            corner = vector_between(points, cell, circumcenters, rings[slot])
            inside = inside and dot_product(corner, corner) < square
        nodes[cell] = 0 if inside else len(RULE) * (stop - start)
        if inside:
            mx, my, mz, energy = cell_moment(points, circumcenters, ring_starts, rings, cell)
            radial, value = x * mx + y * my + z * mz, values[patch]
            sums[cell, 0] = value * (radial + 0.5 * energy)
            sums[cell, 1], sums[cell, 2] = value * (mx - radial * x), value * (my - radial * y)
            sums[cell, 3], sums[cell, 4] = value * (mz - radial * z), value * radial
            sums[cell, 5] = value * energy


@numba.njit(parallel=True, cache=True)
def _quadrature_points(
    points: Array,
    circumcenters: Array,
    ring_starts: Index,
    rings: Index,
    cells: Index,
    rows: Index,
    is_flat: bool,
    nodes: Array,
) -> None:
    """Write the quadrature points of the `cells` (k,) to `nodes`, ring after ring, from the row `rows` (k,) on."""
    for index in numba.prange(len(cells)):
        cell, row = cells[index], rows[index]
        start, stop = ring_starts[cell], ring_starts[cell + 1]
        u = vector_between(points, cell, circumcenters, rings[stop - 1])
        for slot in range(start, stop):
            v = vector_between(points, cell, circumcenters, rings[slot])
            for node in range(len(RULE)):
                s, t = RULE[node, 0], RULE[node, 1]
                x = points[cell, 0] + s * u[0] + t * v[0]
                y = points[cell, 1] + s * u[1] + t * v[1]
                z = points[cell, 2] + s * u[2] + t * v[2]
                factor = 1.0 if is_flat else 1.0 / np.sqrt(x * x + y * y + z * z)
                nodes[row, 0], nodes[row, 1], nodes[row, 2] = factor * x, factor * y, factor * z
                row += 1
            u = v


@numba.njit(parallel=True, cache=True)
def _sum_cells(
    points: Array,
    circumcenters: Array,
    ring_starts: Index,
    rings: Index,
    cells: Index,
    rows: Index,
    values: Array,
    is_flat: bool,
    sums: Array,
) -> None:
    """Write the integrals of the `cells` (k,), from values of the density at the nodes, to rows of `sums`.

    Columns: mass; tangential part of the moment (three); x.M; energy.
    """
    for index in numba.prange(len(cells)):
        cell, row = cells[index], rows[index]
        start, stop = ring_starts[cell], ring_starts[cell + 1]
        px, py, pz = outward(points, cell, is_flat)
        u = vector_between(points, cell, circumcenters, rings[stop - 1])
        mass, radial, energy = 0.0, 0.0, 0.0
        mx, my, mz = 0.0, 0.0, 0.0
        for slot in range(start, stop):
            v = vector_between(points, cell, circumcenters, rings[slot])
            area = triple_product((px, py, pz), u, v)
            for node in range(len(RULE)):
                s, t = RULE[node, 0], RULE[node, 1]
                qx = s * u[0] + t * v[0]
                qy = s * u[1] + t * v[1]
                qz = s * u[2] + t * v[2]
                along = px * qx + py * qy + pz * qz
                square = qx * qx + qy * qy + qz * qz
                inverse = 1.0 if is_flat else 1.0 / np.sqrt(1.0 + 2.0 * along + square)
                weight = RULE[node, 2] * area * values[row] * inverse**3
                cosine = (1.0 + along) * inverse
                mass += weight
                radial += weight * cosine
                energy += weight * 2.0 * (square - along * along) * inverse**2 / (1.0 + cosine)
                mx += weight * inverse * (qx - along * px)
                my += weight * inverse * (qy - along * py)
                mz += weight * inverse * (qz - along * pz)
                row += 1
            u = v
        sums[cell, 0], sums[cell, 4], sums[cell, 5] = mass, radial, energy
        sums[cell, 1], sums[cell, 2], sums[cell, 3] = mx, my, mz


@numba.njit(parallel=True, cache=True)
def _gradient_and_partials(
    sums: Array,
    fixed: NDArray[np.bool_],
    direction: Array,
    old_scales: Array,
    gradient: Array,
    scales: Array,
    partials: Array,
) -> None:
    """As `moments.evaluate`, from the sums (n, 6); `fixed` cells have no gradient and no part in the residual."""
    for block in numba.prange(len(partials)):
        energy, slope, largest = 0.0, 0.0, 0.0
        for cell in range(block * BLOCK, min((block + 1) * BLOCK, len(sums))):
            radial = sums[cell, 4]
            scales[cell] = 1.0 / np.sqrt(2.0 * radial)
            energy += sums[cell, 5]
            if fixed[cell]:
                gradient[cell, 0], gradient[cell, 1], gradient[cell, 2] = 0.0, 0.0, 0.0
                continue
            square = 0.0
            for axis in range(3):
                component = sums[cell, 1 + axis]
                gradient[cell, axis] = -2.0 * scales[cell] * component
                slope -= 2.0 * old_scales[cell] * component * direction[cell, axis]
                square += component * component
            largest = max(largest, square / (radial * radial))
        partials[block, 0], partials[block, 1], partials[block, 2] = energy, slope, largest


class WeightedCells:
    """Integrals over Voronoi cells under a density; generators that are `fixed` (n,) do not move.

    Cells are on the unit sphere or, of a flat surface, in the plane z = 0, where x.M stands for the mass.

    Where the density is extremely large or small, the integrals are those of a multiple of it. With `often`, for
    callers who integrate many times, plateaus of the density are sought first, where its values are then known.
    """

    def __init__(
        self,
        density: Density,
        n_cells: int,
        fixed: NDArray[np.bool_] | None = None,
        often: bool = False,
        surface: Surface = UNIT_SPHERE,
    ) -> None:
        is_flat = surface.is_flat
        self._density = density if is_flat else within_range(density)
        self._plateaus = plateaus_of(self._density, n_cells) if often and not is_flat else None
        self._surface, self._is_flat = surface, is_flat
        self._sums = np.empty((n_cells, 6))
        self._fixed = np.zeros(n_cells, bool) if fixed is None else fixed
        self._counts = np.empty(n_cells, np.int32)
        self._nodes = np.empty((0, 3))

    def integrate(self, points: Array, circumcenters: Array, ring_starts: Index, rings: Index) -> Array:
        """Mass, tangential moment (three), x.M and energy of all cells, (n, 6), in a buffer that the next call reuses.

        Raises `MeshError` where the density is negative, not finite or zero on a whole cell.
        """
        mesh = (points, circumcenters, ring_starts, rings)
        if self._plateaus is None:
            np.multiply(np.diff(ring_starts), len(RULE), out=self._counts)
        else:
            known: Plateaus = self._plateaus
            _integrate_on_plateaus(*mesh, known.resolution, known.values, known.reaches, self._sums, self._counts)
        varied = np.flatnonzero(self._counts)
        for first in range(0, len(varied), CHUNK):
            cells = varied[first : first + CHUNK]
            ends = np.cumsum(self._counts[cells])
            if len(self._nodes) < ends[-1]:
                self._nodes = np.empty((ends[-1], 3))
            rows, nodes = ends - self._counts[cells], self._nodes[: ends[-1]]
            _quadrature_points(*mesh, cells, rows, self._is_flat, nodes)
            values = density_at(self._density, nodes, self._surface)
            _sum_cells(*mesh, cells, rows, values, self._is_flat, self._sums)
        empty = np.flatnonzero(self._sums[:, 4] <= 0.0)
        if len(empty):
            raise MeshError(
                f"the density is zero on the whole cell at {self._surface.in_words(points[empty[0]])}; "
                "give it a floor above zero"
            )
        return self._sums

    def evaluate(
        self,
        points: Array,
        circumcenters: Array,
        ring_starts: Index,
        rings: Index,
        direction: Array,
        old_scales: Array,
        gradient: Array,
        scales: Array,
        partials: Array,
    ) -> None:
        """As `moments.evaluate`, under the density and without the fixed generators."""
        self.integrate(points, circumcenters, ring_starts, rings)
        _gradient_and_partials(self._sums, self._fixed, direction, old_scales, gradient, scales, partials)


def centroid_distances(sums: Array) -> Array:
    """Distances (n,), chords, from generators to constrained centroids, from what `WeightedCells.integrate` gives."""
    square = (sums[:, 1:4] ** 2).sum(axis=1) / sums[:, 4] ** 2
    root = np.sqrt(1.0 + square)
    return np.sqrt(2.0 * square / (root * (1.0 + root)))
