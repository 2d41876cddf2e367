"""Local truncation errors of the discrete operators on a mesh: what they make of exact samples of smooth fields.

The flow is that of test case 6 of Williamson et al. (1992) with a divergent part, on the unit sphere:

    psi = -z + z Re (x + iy)^4        chi = 2 x y z        u = k x grad(psi) + grad(chi)

All terms are spherical harmonics, so that vorticity and divergence are psi and chi times -n (n + 1), and there is no
trouble at the poles. Operators are given the exact normal component at the edge points, which lie midway between cell
centres, and compared with the exact result at the place where theirs lives.
"""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.discrete.operators import build_operators
from mesh.geometry.sphere import dot, east_north, from_lonlat
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.compare.norms import Norms, scalar_norms
from swe.configuration import Options, SchemeName
from swe.run.composition import SCHEMES


@dataclass(frozen=True)
class Result:
    """Result of an operator beside the exact one, and the areas that weight them, all on the unit sphere.

    Values are at edges for the gradient and perp, at cells for the divergence and the kinetic energy, and at vertices
    for the curl.
    """

    values: Array
    exact: Array
    area: Array


@dataclass(frozen=True)
class Results:
    """One result for each operator; names and definitions as in `mesh.discrete.operators.Operators`."""

    gradient: Result
    divergence: Result
    curl: Result
    perp: Result
    kinetic_energy: Result


@dataclass(frozen=True)
class TruncationErrors:
    """Norms of the truncation error of each operator relative to those of the exact result."""

    gradient: Norms
    divergence: Norms
    curl: Norms
    perp: Norms
    kinetic_energy: Norms


def truncation_errors(mesh: VoronoiMesh, scheme: SchemeName = Options.scheme) -> TruncationErrors:
    """Norms, weighted by area, of the truncation errors on `mesh`, which do not depend on its radius."""
    results = vars(apply_operators(mesh, scheme))
    return TruncationErrors(**{name: scalar_norms(one.values, one.exact, one.area) for name, one in results.items()})


def apply_operators(mesh: VoronoiMesh, scheme: SchemeName = Options.scheme) -> Results:
    """Apply the operators of `mesh`, scaled to the unit sphere, to the flow; the gradient to its streamfunction.

    The kinetic energy is that of the scheme, all others are the same for every scheme.
    """
    mesh = mesh.scaled(1.0)
    operators = build_operators(mesh)
    cells = from_lonlat(mesh.lon_cell, mesh.lat_cell)
    edges = from_lonlat(mesh.lon_edge, mesh.lat_edge)
    vertices = from_lonlat(mesh.lon_vertex, mesh.lat_vertex)
    east, north = east_north(mesh.lon_edge, mesh.lat_edge)
    normal = np.cos(mesh.angle_edge)[:, None] * east + np.sin(mesh.angle_edge)[:, None] * north
    tangent = np.cross(edges, normal)
    normal_velocity = dot(velocity(edges), normal)
    speed = np.linalg.norm(velocity(cells), axis=1)
    kinetic_energy = np.empty(mesh.n_cells)
    SCHEMES[scheme](mesh).kinetic_energy(normal_velocity, kinetic_energy)
    # Twice the quadrilateral of an edge's cells and vertices; only the ratios of the weights matter.
    area_edge = mesh.dc_edge * mesh.dv_edge
    return Results(
        Result(operators.gradient @ streamfunction(cells), dot(streamfunction_gradient(edges), normal), area_edge),
        Result(operators.divergence @ normal_velocity, divergence(cells), mesh.area_cell),
        Result(operators.curl @ normal_velocity, vorticity(vertices), mesh.area_triangle),
        Result(operators.perp @ normal_velocity, dot(velocity(edges), tangent), area_edge),
        Result(kinetic_energy, 0.5 * speed**2, mesh.area_cell),
    )


def streamfunction(points: Array) -> Array:
    """Streamfunction psi at unit vectors (n, 3)."""
    x, y, z = points.T
    return -z + z * _wave(x, y)


def streamfunction_gradient(points: Array) -> Array:
    """Gradient (n, 3) of psi along the sphere at unit vectors (n, 3)."""
    x, y, z = points.T
    slope = np.stack([4.0 * z * (x**3 - 3.0 * x * y**2), 4.0 * z * (y**3 - 3.0 * x**2 * y), _wave(x, y) - 1.0], axis=1)
    return _tangential(slope, points)


def velocity(points: Array) -> Array:
    """Velocity (n, 3) at unit vectors (n, 3), tangential to the sphere."""
    x, y, z = points.T
    divergent = _tangential(2.0 * np.stack([y * z, x * z, x * y], axis=1), points)
    return np.cross(points, streamfunction_gradient(points)) + divergent


def vorticity(points: Array) -> Array:
    """Relative vorticity at unit vectors (n, 3): -z has degree 1, the wave degree 5."""
    x, y, z = points.T
    return 2.0 * z - 30.0 * z * _wave(x, y)


def divergence(points: Array) -> Array:
    """Divergence at unit vectors (n, 3): the potential has degree 3."""
    x, y, z = points.T
    return -24.0 * x * y * z


def _wave(x: Array, y: Array) -> Array:
    """Real part of (x + iy)^4, which is cos(lat)^4 cos(4 lon)."""
    return x**4 - 6.0 * x**2 * y**2 + y**4


def _tangential(vectors: Array, points: Array) -> Array:
    """Vectors without their radial part."""
    return vectors - dot(vectors, points)[:, None] * points
