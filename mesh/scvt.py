"""Spherical centroidal Voronoi tessellations of uniform density: Lloyd's method and preconditioned L-BFGS.

Both lower the clustering energy E = sum_i of the integral of |x - x_i|^2 over Voronoi cell i (Du, Faber and
Gunzburger 1999). With m_i the mass of a cell and M_i its moment, the integral of x, the tangential gradient is
that of 2 (m_i x_i - M_i); it vanishes where every generator is the constrained centroid M_i/|M_i| of its cell.
"""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from mesh.arrays import Array, Index, sum_by_index
from mesh.delaunay import delaunay, half_edge_twins, is_delaunay
from mesh.errors import MeshError
from mesh.sphere import arc_length, circumcenter, dot, normalize, triangle_area

LBFGS_PAIRS = 7
MAXIMUM_HALVINGS = 20


@dataclass
class History:
    """What each iteration reached: energy (radian^2 steradian), residual (mean spacings), seconds since the start."""

    energy: list[float] = field(default_factory=list)
    residual: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)

    @property
    def iterations(self) -> int:
        """Number of iterations, the starting points not counted."""
        return len(self.residual) - 1


@dataclass(frozen=True)
class Tessellation:
    """Generators with their triangulation and the integrals over their Voronoi cells, unit sphere and density."""

    points: Array
    triangles: Index
    twins: Index
    mass: Array
    moment: Array
    energy: float

    @property
    def gradient(self) -> Array:
        """Tangential gradient of the energy (n_cells, 3)."""
        return tangential(2.0 * (self.mass[:, None] * self.points - self.moment), self.points)

    @property
    def residual(self) -> float:
        """Largest distance between a generator and its constrained centroid, in mean spacings."""
        distance = arc_length(self.points, normalize(self.moment))
        return float(distance.max()) / mean_spacing(len(self.points))


@dataclass(frozen=True)
class ScvtResult:
    """Converged generators (n_cells, 3), their Delaunay triangles and the convergence history."""

    points: Array
    triangles: Index
    history: History


Callback = Callable[[int, float, float], None]
"""Called after each iteration with its number, the residual and the energy."""


def mean_spacing(n_cells: int) -> float:
    """Distance (radians) between neighbours if all cells were equal plane hexagons."""
    return float(np.sqrt(8.0 * np.pi / (np.sqrt(3.0) * n_cells)))


def tangential(vectors: Array, points: Array) -> Array:
    """The part of vectors (n, 3) that is tangent to the sphere at unit vectors `points`."""
    return vectors - dot(vectors, points)[:, None] * points


def tessellate(points: Array, previous: Tessellation | None = None) -> Tessellation:
    """Triangulate unit vectors `points` and integrate over their Voronoi cells.

    The triangulation of `previous` is kept where it still is Delaunay for the moved points.
    """
    if previous is not None and is_delaunay(points, previous.triangles, previous.twins):
        triangles, twins = previous.triangles, previous.twins
    else:
        triangles = delaunay(points)
        twins = half_edge_twins(triangles)
    mass, moment = mass_and_moment(points, triangles, twins)
    energy = 2.0 * float(np.sum(mass - dot(points, moment)))
    return Tessellation(points, triangles, twins, mass, moment, energy)


def mass_and_moment(points: Array, triangles: Index, twins: Index) -> tuple[Array, Array]:
    """Area (n_cells,) and integral of position (n_cells, 3) of every Voronoi cell.

    The moment of a spherical polygon is exactly half the sum over its sides of arc length times the inward unit
    normal of the side's plane; that plane bisects two generators, so its normal is their difference.
    """
    n_cells = len(points)
    vertices = circumcenter(*(points[triangles[:, k]] for k in range(3)))
    half_edge = np.flatnonzero(np.arange(len(twins)) < twins)
    first, second = triangles.ravel()[half_edge], triangles.ravel()[twins[half_edge]]
    left, right = vertices[half_edge // 3], vertices[twins[half_edge] // 3]
    difference = points[first] - points[second]
    arc = 0.5 * arc_length(left, right) / np.sqrt(dot(difference, difference))
    area_first = triangle_area(points[first], right, left)
    area_second = triangle_area(points[second], left, right)
    mass = sum_by_index(first, area_first, n_cells) + sum_by_index(second, area_second, n_cells)
    moment = np.empty((n_cells, 3))
    for axis in range(3):
        part = arc * difference[:, axis]
        moment[:, axis] = sum_by_index(first, part, n_cells) - sum_by_index(second, part, n_cells)
    return mass, moment


def optimize(
    points: Array,
    method: str = "lbfgs",
    tolerance: float = 1e-8,
    max_iterations: int = 10_000,
    callback: Callback | None = None,
) -> ScvtResult:
    """Move unit vectors `points` (n_cells, 3) until they form an SCVT.

    `method` is `lbfgs` or `lloyd`; `tolerance` is the largest distance between a generator and its constrained
    centroid, in mean spacings. Raises `MeshError` for an unknown method, or when `tolerance` is not reached.
    """
    if method not in ("lbfgs", "lloyd"):
        raise MeshError(f"there is no optimisation method named '{method}'; choose lbfgs or lloyd")
    if not tolerance > 0.0:
        raise MeshError(f"the tolerance is {tolerance:g} mean spacings; it must be positive")
    direction = _LbfgsDirection() if method == "lbfgs" else _lloyd_direction
    present = tessellate(points)
    history, begin = History(), time.perf_counter()
    for iteration in range(max_iterations + 1):
        history.energy.append(present.energy)
        history.residual.append(present.residual)
        history.seconds.append(time.perf_counter() - begin)
        if callback is not None:
            callback(iteration, history.residual[-1], present.energy)
        if history.residual[-1] <= tolerance:
            return ScvtResult(present.points, present.triangles, history)
        following = _line_search(present, direction(present))
        if following is None:
            break
        present = following
    raise MeshError(
        f"the mesh of {len(points)} cells stands at a centroid residual of {history.residual[-1]:.1e} mean spacings "
        f"after {history.iterations} iterations and does not reach the tolerance {tolerance:.1e}; "
        "ask for a larger tolerance or more iterations"
    )


def _lloyd_direction(present: Tessellation) -> Array:
    """The step to the constrained centroids, which is the gradient scaled by -1/(2 m)."""
    return -present.gradient / (2.0 * present.mass[:, None])


class _LbfgsDirection:
    """Quasi-Newton directions from the last few steps, with Lloyd's step as the initial inverse Hessian.

    Two-loop recursion: Nocedal and Wright (2006), algorithm 7.4. Vectors at different points are compared in
    space, not transported; steps are short against the radius.
    """

    def __init__(self) -> None:
        self.pairs: deque[tuple[Array, Array, float]] = deque(maxlen=LBFGS_PAIRS)
        self.previous: tuple[Array, Array] | None = None

    def __call__(self, present: Tessellation) -> Array:
        gradient = present.gradient
        if self.previous is not None:
            step, change = present.points - self.previous[0], gradient - self.previous[1]
            curvature = float(np.sum(step * change))
            if curvature > 0.0:
                self.pairs.append((step, change, curvature))
        self.previous = (present.points, gradient)
        direction = tangential(-self._apply_inverse_hessian(gradient, present.mass), present.points)
        if np.sum(direction * gradient) >= 0.0:
            self.pairs.clear()
            return _lloyd_direction(present)
        return direction

    def _apply_inverse_hessian(self, gradient: Array, mass: Array) -> Array:
        vector = gradient.copy()
        factors = []
        for step, change, curvature in reversed(self.pairs):
            factor = np.sum(step * vector) / curvature
            vector -= factor * change
            factors.append(factor)
        vector /= 2.0 * mass[:, None]
        for (step, change, curvature), factor in zip(self.pairs, reversed(factors), strict=True):
            vector += (factor - np.sum(change * vector) / curvature) * step
        return vector


def _line_search(present: Tessellation, direction: Array) -> Tessellation | None:
    """The tessellation after the longest of the steps 1, 1/2, 1/4, ... that does not raise the energy.

    Where the change of energy is lost in round-off, the mean of the slopes at both ends decides. None where no
    step is left.
    """
    slope = float(np.sum(present.gradient * direction))
    rounding = 16.0 * np.finfo(float).eps * float(present.mass.sum())
    length = 1.0
    for _ in range(MAXIMUM_HALVINGS):
        following = tessellate(normalize(present.points + length * direction), present)
        change = following.energy - present.energy
        if abs(change) <= rounding:
            change = 0.5 * length * (slope + float(np.sum(following.gradient * direction)))
        if change <= 0.0:
            return following
        length *= 0.5
    return None
