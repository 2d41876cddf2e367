"""From the description of a mesh to the mesh of a plane."""

import math
import time
from dataclasses import replace

from mesh.arrays import Array
from mesh.density.named import Density, uniform
from mesh.density.planar import density_on_plane
from mesh.errors import MeshError
from mesh.generation.optimizer import Callback, Iterate, Limits, Optimizer, ScvtResult
from mesh.generation.scvt import cells_of, check_converged, limits_of
from mesh.mesh_request import MeshRequest
from mesh.plane.domain import Rectangle, rectangle
from mesh.plane.grids import plane_preconditioner
from mesh.plane.hexagons import hexagon_mesh
from mesh.plane.moving import PlaneCells
from mesh.plane.plane_mesh import plane_mesh
from mesh.plane.starts import starting_points
from mesh.voronoi_mesh import VoronoiMesh

METHODS = ("lbfgs", "lloyd")

WIDEST = 10.0
"""Times the shorter side of a plane that cells may be wide."""

FIRST_ITERATIONS = 30
"""Iterations without coarse grids. From random points, grids move whole regions at once, so that small triangles turn
over and the triangulation has to be made anew: 20 times in 616 iterations on 40000 cells, and once in 474 after these.
"""


def mesh_on_plane(request: MeshRequest, callback: Callback | None = None) -> VoronoiMesh:
    """The validated mesh, on a plane, that the `request` describes: regular hexagons, or a centroidal Voronoi mesh.

    Besides the plane count cells, density, start (`mesh.plane.starts`), method (`lbfgs` or `lloyd`), tolerance,
    iterations, seconds and seed; with hexagons, nothing else. Raises `MeshError` if no such mesh can be made.
    """
    begin = time.perf_counter()
    plane = require_possible_on_plane(request)
    if request.hexagons is not None:
        return hexagon_mesh((plane.width, plane.height), request.hexagons, request.periodic)
    density = density_on_plane(request, plane.lengths)
    limits = limits_of(request)
    points = starting_points(plane, cells_of(request), density, request.start, request.seed)
    result = converge_on_plane(points, plane, request.method, density, limits.since(begin), callback)
    check_converged(result, limits)
    return plane_mesh(result.points, plane, density)


def is_on_plane(request: MeshRequest) -> bool:
    """Whether the request is for a mesh on a plane; raises `MeshError` where it only says how such a one is to be."""
    of_plane = (request.periodic, request.hexagons) != (MeshRequest.periodic, MeshRequest.hexagons)
    if request.plane is None and of_plane:
        raise MeshError("--periodic and --hexagons go with --plane LX,LY; give its lengths, or leave them out")
    return request.plane is not None


def converge_on_plane(
    points: Array,
    plane: Rectangle,
    method: str = MeshRequest.method,
    density: Density = uniform,
    limits: Limits | None = None,
    callback: Callback | None = None,
) -> ScvtResult:
    """Move generators `points` (n, 3), z = 0, to the centroids of their cells in a rectangle.

    They are not brought back where they leave it. L-BFGS has coarse grids after its `FIRST_ITERATIONS`. Raises
    `MeshError` for an unknown method, where points coincide, or
    where the density cannot be used.
    """
    begin, limits = time.perf_counter(), Limits() if limits is None else limits

    def at_images(places: Array) -> Array:
        return density(plane.folded(places))

    def descent(points: Array, with_grids: bool) -> Optimizer:
        return Optimizer(
            points,
            method=method,
            density=None if density is uniform else at_images,
            cells=PlaneCells(points, plane),
            spacing=plane.spacing(len(points)),
            surface=plane.surface,
            preconditioner=plane_preconditioner(points, plane) if with_grids else None,
        )

    if method != "lbfgs" or limits.iterations <= FIRST_ITERATIONS:
        return descent(points, False).run(limits, callback)
    first = descent(points, False).run(replace(limits, iterations=FIRST_ITERATIONS), callback)
    if first.reason != "iterations":
        return first
    left = replace(limits.since(begin), iterations=limits.iterations - FIRST_ITERATIONS)
    second = descent(first.points, True).run(left, _counted_on(callback))
    return replace(second, history=first.history.followed_by(second.history))


def _counted_on(callback: Callback | None) -> Callback | None:
    """The callback for iterations that follow the first ones; it has seen the points with which they begin."""
    if callback is None:
        return None

    def call(iterate: Iterate) -> None:
        if iterate.number > 0:
            callback(replace(iterate, number=iterate.number + FIRST_ITERATIONS))

    return call


def require_possible_on_plane(request: MeshRequest) -> Rectangle:
    """The plane that is asked for; raise `MeshError` if the request asks for what a mesh on it cannot have."""
    if request.plane is None:
        raise MeshError("a mesh on a plane needs its lengths; give --plane LX,LY")
    plane = rectangle(request.plane, request.periodic)
    alone = MeshRequest(plane=request.plane, periodic=request.periodic, hexagons=request.hexagons)
    if request.hexagons is not None and request != alone:
        raise MeshError("only --plane and --periodic go with --hexagons; leave all else out that tells of the mesh")
    if request.hexagons is None and request.cells is None:
        raise MeshError("a mesh on a plane needs cells; give --cells N, or --hexagons NX,NY")
    if request.nested is not None or request.well_centered:
        raise MeshError("a mesh on a plane is neither nested nor made well-centred; leave these options out")
    if request.method not in METHODS:
        raise MeshError(f"a mesh on a plane cannot use the method {request.method}; choose {' or '.join(METHODS)}")
    if request.cells is not None and request.cells > 0:
        _require_narrow(request.cells, plane)
    return plane


def _require_narrow(cells: int, plane: Rectangle) -> None:
    """Raise `MeshError` where cells would be far wider than the plane, across which all of them have images."""
    side = float(plane.lengths.min())
    widths = plane.spacing(cells) / side
    if widths > WIDEST:
        raise MeshError(
            f"{cells} cells would be {widths:.3g} times as wide as the shorter side of the plane, {side:g} m; ask for "
            f"at least {math.ceil(cells * (widths / WIDEST) ** 2)}, or for another plane"
        )
