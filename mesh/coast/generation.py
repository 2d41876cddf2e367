"""From the description of a mesh and a region to a mesh whose cells the coast of the region clips."""

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from mesh.arrays import Array
from mesh.coast.coastline import Coastline
from mesh.coast.raised import RaisedDensity
from mesh.coast.sea_cells import SeaCells, SeaResult
from mesh.coast.sea_mesh import sea_mesh
from mesh.coast.short_edges import Part, without_short_edges
from mesh.coast.start import FEWEST_CELLS, fillers, sea_spacing, starting_points
from mesh.density.named import Density, uniform
from mesh.errors import MeshError
from mesh.generation.optimizer import Callback, Limits, Optimizer
from mesh.generation.scvt import VARIABLE_TOLERANCE, cells_of, check_converged, density_of, limits_of
from mesh.geometry.sphere import fibonacci_points
from mesh.integrals.weighted_moments import WeightedCells, centroid_distances
from mesh.mesh_request import MeshRequest
from mesh.regions.coastline import LONGEST
from mesh.regions.region import Region
from mesh.voronoi_mesh import VoronoiMesh

SAMPLES = 200_000
"""Points on the sphere that tell, before there is a coastline, how large the sea is."""

METHODS = ("lbfgs", "lloyd")

COAST_SPACINGS = 1.5
"""Width, in mean spacings, to which the coast is smoothed: bays as narrow as one spacing end in cells of two sides."""


PART_ITERATIONS = 500
"""Iterations for a part of a sea, which mostly takes 50 to 150: one that takes more has gone wrong."""


@dataclass(frozen=True)
class Shore:
    """How a density rises towards the coast: `factor` times at the coast, over a `width` in radians."""

    width: float
    factor: float


def region_mesh(
    region: Region,
    request: MeshRequest,
    callback: Callback | None = None,
    shore: Shore | None = None,
    smoothing: float | None = None,
) -> VoronoiMesh:
    """The validated mesh, on the unit sphere, of the cells that fill the sea of a region up to its coast.

    The coast is smoothed to the width `smoothing`, radians, by default `COAST_SPACINGS` mean spacings. Of the `request`
    count cells, density, start (`fibonacci` by default, and spread evenly under a density), method (`lbfgs` or
    `lloyd`), tolerance (1e-6 mean spacings by default), iterations, seconds and seed. Short edges are mended
    (`mesh.coast.short_edges`). Raises `MeshError` if no such mesh can be made.
    """
    require_possible_with_coast(request)
    begin, density = time.perf_counter(), density_of(request)
    limits = coast_limits(request)
    smoothing = coast_smoothing(region, cells_of(request)) if smoothing is None else smoothing
    rings = region.coastline(smoothing)
    if shore is not None:
        density = RaisedDensity(density, np.concatenate(rings), shore.width, shore.factor)
    coastline = Coastline(rings)
    points = starting_points(coastline, cells_of(request), density, request.start, request.seed)
    found = converge_at_sea(coastline, points, request.method, density, limits.since(begin), callback)
    check_converged(found.result, limits)

    descent = SeaDescent(coastline, density, limits, begin, callback)
    found = without_short_edges(found, descent, limits.tolerance, request.seed)
    return sea_mesh(found.sea, found.result.points, density)


def require_possible_with_coast(request: MeshRequest) -> None:
    """Raise `MeshError` if the request asks for what a mesh with a coast cannot have."""
    if request.nested is not None or request.well_centered:
        raise MeshError("a mesh with a coast is neither nested nor made well-centred; leave these options out")
    if request.method not in METHODS:
        raise MeshError(f"a mesh with a coast cannot use the method {request.method}; choose {' or '.join(METHODS)}")


def coast_limits(request: MeshRequest) -> Limits:
    """Limits of the requested optimisation, by default with the tolerance of other densities than the uniform one."""
    tolerance = VARIABLE_TOLERANCE if request.tolerance is None else request.tolerance
    return replace(limits_of(request), tolerance=tolerance)


def spacing_before_coastline(region: Region, cells: int) -> float:
    """Distance (radians) between neighbours if `cells` filled the region, whose coast may still have to be smoothed."""
    part = np.count_nonzero(region.contains(fibonacci_points(SAMPLES))) / SAMPLES
    if part == 0.0:
        raise MeshError(f"{region.name}: there is no sea, or hardly any; take another region")
    return float(np.sqrt(8.0 * np.pi * part / (np.sqrt(3.0) * cells)))


def coast_smoothing(region: Region, cells: int) -> float:
    """Width (radians) to which the coast of a region is smoothed for a mesh of so many cells.

    Raises `MeshError` where these are too few for any coast.
    """
    if cells < FEWEST_CELLS:
        raise MeshError(f"a mesh of {cells} cells is too small; ask for at least {FEWEST_CELLS}")
    smoothing = COAST_SPACINGS * spacing_before_coastline(region, cells)
    if smoothing > LONGEST:
        enough = math.ceil(cells * (smoothing / LONGEST) ** 2)
        raise MeshError(f"{region.name}: {cells} cells are too few to follow its coast; ask for at least {enough}")
    return smoothing


def converge_at_sea(
    coastline: Coastline,
    points: Array,
    method: str = MeshRequest.method,
    density: Density = uniform,
    limits: Limits | None = None,
    callback: Callback | None = None,
) -> SeaResult:
    """Move generators `points` (n, 3) in the sea to the centroids of their clipped cells.

    Raises `MeshError` for an unknown method, or where points cannot be triangulated or the density cannot be used.
    """
    limits = Limits(tolerance=VARIABLE_TOLERANCE) if limits is None else limits
    spacing = sea_spacing(coastline, len(points))
    sea = SeaCells(points, coastline, fillers(coastline, spacing))
    weight = None if density is uniform else density
    optimizer = Optimizer(points, method=method, density=weight, cells=sea, spacing=spacing)
    return SeaResult(optimizer.run(limits, callback), sea)


@dataclass(frozen=True, eq=False)
class SeaDescent:
    """Descents at sea under a density, with what is left of `limits` since `time.perf_counter` gave `begin`.

    `callback` hears of those of the whole sea. What they do is told in `mesh.coast.short_edges.Descent`.
    """

    coastline: Coastline
    density: Density
    limits: Limits
    begin: float
    callback: Callback | None = None

    def whole(self, points: Array, tolerance: float) -> SeaResult:
        """What all generators (n, 3) converge to."""
        limits = replace(self.limits.since(self.begin), tolerance=tolerance)
        return converge_at_sea(self.coastline, points, density=self.density, limits=limits, callback=self.callback)

    def part(self, points: Array, tolerance: float, part: Part) -> SeaResult:
        """What the generators (k, 3) of a part converge to, in `PART_ITERATIONS` at most."""
        limits = replace(
            self.limits.since(self.begin),
            tolerance=tolerance,
            iterations=min(self.limits.iterations, PART_ITERATIONS),
        )
        sea = SeaCells(points, self.coastline, part.fillers)
        optimizer = Optimizer(points, density=self._weight, fixed=part.held, cells=sea, spacing=part.spacing)
        return SeaResult(optimizer.run(limits), sea)

    def residuals(self, points: Array) -> Array:
        """Distances (n,) of all generators (n, 3) from the centroids of their cells, in mean spacings."""
        spacing = sea_spacing(self.coastline, len(points))
        sea = SeaCells(points, self.coastline, fillers(self.coastline, spacing))
        sums = WeightedCells(self.density, len(points)).integrate(points, sea.circumcenters, sea.ring_starts, sea.rings)
        return centroid_distances(sums) / spacing

    @property
    def _weight(self) -> Density | None:
        return None if self.density is uniform else self.density
