"""From the description of a mesh to the mesh of a plane."""

import time

from mesh.arrays import Array
from mesh.density.named import Density, uniform
from mesh.density.planar import density_on_plane
from mesh.errors import MeshError
from mesh.generation.optimizer import Callback, Limits, Optimizer, ScvtResult
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

    They are not brought back where they leave it. Raises `MeshError` for an unknown method, where points coincide, or
    where the density cannot be used.
    """
    limits = Limits() if limits is None else limits

    def at_images(places: Array) -> Array:
        return density(plane.folded(places))

    optimizer = Optimizer(
        points,
        method=method,
        density=None if density is uniform else at_images,
        cells=PlaneCells(points, plane),
        spacing=plane.spacing(len(points)),
        surface=plane.surface,
        preconditioner=plane_preconditioner(points, plane) if method == "lbfgs" else None,
    )
    return optimizer.run(limits, callback)


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
    return plane
