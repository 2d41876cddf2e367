"""The mesh of a run in the UGRID conventions: cells are faces, vertices of the Voronoi cells are nodes.

Indices count from 0 (`start_index`); -1, the fill value, stands beyond the corners of a face, and where a coast leaves
no face on the other side of an edge.
"""

from collections.abc import Callable
from dataclasses import dataclass

import netCDF4
import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.discrete.walls import wall_edges
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import VoronoiMesh

MESH = "mesh"
"""Name of the variable that holds the topology, to which all fields refer."""

FACE_AREA = "face_area"

LOCATIONS = {"nCells": "face", "nEdges": "edge", "nVertices": "node"}
"""What UGRID calls the places of fields; dimensions have the same names."""

CORNERS, TWO, WALLS = "corner", "two", "wall"

FILL = -1


@dataclass(frozen=True)
class Coordinate:
    """One of the two coordinates on a surface: the name that the mesh has for it, what CF calls it, and its units.

    `in_units` turns what the mesh holds into these.
    """

    name: str
    standard_name: str
    units: str
    in_units: Callable[[Array], Array]


ON_SPHERE = (
    Coordinate("lon", "longitude", "degrees_east", np.degrees),
    Coordinate("lat", "latitude", "degrees_north", np.degrees),
)
ON_PLANE = (
    Coordinate("x", "projection_x_coordinate", "m", np.asarray),
    Coordinate("y", "projection_y_coordinate", "m", np.asarray),
)

MEANINGS = {
    "face_nodes": "nodes of each face, counter-clockwise",
    "face_edges": "edges of each face, counter-clockwise; each stands before the node at its end",
    "face_faces": "faces across the edges of each face; none across a coast",
    "edge_nodes": "nodes at the tail and head of each edge; its normal points to the right of the way between them",
    "edge_faces": "faces that the normal of each edge leaves and enters; none beyond a coast",
    "wall_nodes": "nodes of the edges along coasts",
}
"""Connectivity variables and their long names."""


def define_mesh(file: netCDF4.Dataset, mesh: VoronoiMesh) -> None:
    """Define dimensions and variables of the mesh in an open file, with their attributes."""
    walls = wall_edges(mesh)
    sizes = {"face": mesh.n_cells, "edge": mesh.n_edges, "node": mesh.n_vertices}
    sizes |= {CORNERS: _corners(mesh), TWO: 2} | ({WALLS: len(walls)} if len(walls) else {})
    for name, size in sizes.items():
        file.createDimension(name, size)
    file.createVariable(MESH, "i4", ()).setncatts(_topology(mesh, with_walls=len(walls) > 0))
    for location in LOCATIONS.values():
        _define_coordinates(file, mesh, location)
    for name in _connectivity(mesh):
        _define_connectivity(file, name)
    _define_measures(file, mesh)


def fill_mesh(file: netCDF4.Dataset, mesh: VoronoiMesh) -> None:
    """Write what `define_mesh` has defined."""
    file[MESH][...] = 0
    places = {"face": "cell", "edge": "edge", "node": "vertex"}
    for location, place in places.items():
        for each in _coordinates_of(mesh):
            file[f"{location}_{each.name}"][:] = each.in_units(getattr(mesh, f"{each.name}_{place}"))
    for kind, bounds in _bounds(mesh).items():
        file[f"face_{kind}_bounds"][:] = bounds
    for name, values in _connectivity(mesh).items():
        file[name][:] = values
    file[FACE_AREA][:] = mesh.area_cell
    file["edge_normal_angle"][:] = np.degrees(mesh.angle_edge)


def place_attributes(mesh: VoronoiMesh, location: str) -> dict[str, str]:
    """Attributes of a field that say where on the mesh its values are."""
    return {"mesh": MESH, "location": location, "coordinates": _coordinates(mesh, location)}


def surface_attributes(mesh: VoronoiMesh) -> dict[str, float]:
    """Global attributes that tell the sphere, or after which lengths, m, a plane repeats itself."""
    if mesh.on_a_sphere:
        return {"sphere_radius": mesh.sphere_radius}
    return {"x_period": mesh.x_period, "y_period": mesh.y_period}


def _coordinates_of(mesh: VoronoiMesh) -> tuple[Coordinate, Coordinate]:
    return ON_SPHERE if mesh.on_a_sphere else ON_PLANE


def _topology(mesh: VoronoiMesh, with_walls: bool) -> dict[str, str | np.int32]:
    attributes: dict[str, str | np.int32] = {
        "cf_role": "mesh_topology",
        "long_name": f"topology of the Voronoi mesh on {'the sphere' if mesh.on_a_sphere else 'a plane'}",
        "topology_dimension": np.int32(2),
        **{f"{location}_coordinates": _coordinates(mesh, location) for location in LOCATIONS.values()},
        "face_dimension": "face",
        "edge_dimension": "edge",
        "face_node_connectivity": "face_nodes",
        "face_edge_connectivity": "face_edges",
        "face_face_connectivity": "face_faces",
        "edge_node_connectivity": "edge_nodes",
        "edge_face_connectivity": "edge_faces",
    }
    return attributes | ({"boundary_node_connectivity": "wall_nodes"} if with_walls else {})


def _coordinates(mesh: VoronoiMesh, location: str) -> str:
    return " ".join(f"{location}_{each.name}" for each in _coordinates_of(mesh))


def _define_coordinates(file: netCDF4.Dataset, mesh: VoronoiMesh, location: str) -> None:
    for each in _coordinates_of(mesh):
        name = f"{location}_{each.name}"
        variable = file.createVariable(name, "f8", (location,), fill_value=False)
        long_name = f"{each.standard_name if mesh.on_a_sphere else each.name} of {location}s"
        variable.setncatts({"standard_name": each.standard_name, "long_name": long_name, "units": each.units})
        if location == "face":
            variable.bounds = f"{name}_bounds"
            file.createVariable(variable.bounds, "f8", (location, CORNERS), fill_value=False)


def _define_connectivity(file: netCDF4.Dataset, name: str) -> None:
    location, of = name.split("_")
    dimensions = (WALLS if location == "wall" else location, CORNERS if location == "face" else TWO)
    role = "boundary_node" if location == "wall" else f"{location}_{of.removesuffix('s')}"
    fill = False if of == "nodes" and location != "face" else np.int32(FILL)  # every edge has two nodes
    variable = file.createVariable(name, "i4", dimensions, fill_value=fill)
    variable.setncatts({"cf_role": f"{role}_connectivity", "long_name": MEANINGS[name], "start_index": np.int32(0)})


def _define_measures(file: netCDF4.Dataset, mesh: VoronoiMesh) -> None:
    area = file.createVariable(FACE_AREA, "f8", ("face",), fill_value=False)
    area.setncatts({"standard_name": "cell_area", "long_name": "area of faces", "units": "m2"})
    area.setncatts(place_attributes(mesh, "face"))
    angle = file.createVariable("edge_normal_angle", "f8", ("edge",), fill_value=False)
    origin = "east" if mesh.on_a_sphere else "the x axis"
    angle.setncatts({"long_name": f"angle of the normal of edges, counter-clockwise from {origin}", "units": "degrees"})
    angle.setncatts(place_attributes(mesh, "edge"))


def _connectivity(mesh: VoronoiMesh) -> dict[str, NDArray[np.int32]]:
    """Values of the connectivity variables by name, (face, corner) or (n, 2), -1 where there is nothing."""
    used, corners = mesh.on_ring, _corners(mesh)
    rings = {"face_nodes": mesh.vertices_on_cell, "face_edges": mesh.edges_on_cell, "face_faces": mesh.cells_on_cell}
    found = {name: np.where(used, values, FILL)[:, :corners] for name, values in rings.items()}
    found |= {"edge_nodes": mesh.vertices_on_edge, "edge_faces": mesh.cells_on_edge}
    walls = wall_edges(mesh)
    return found | ({"wall_nodes": mesh.vertices_on_edge[walls]} if len(walls) else {})


def _corners(mesh: VoronoiMesh) -> int:
    """Most corners of a face; files from other programs may have wider rings."""
    return int(mesh.n_edges_on_cell.max())


def _bounds(mesh: VoronoiMesh) -> dict[str, Array]:
    """Coordinates of the corners of faces (face, corner), degrees or m; the last corner is repeated.

    Longitudes are within 180 degrees of that of the face, so that no face is torn where they start again; so are those
    on a plane within half a period.
    """
    last = np.minimum(np.arange(_corners(mesh)), mesh.n_edges_on_cell[:, None] - 1)
    corners = np.take_along_axis(mesh.vertices_on_cell, last, axis=1)
    if not mesh.on_a_sphere:
        ways = surface_of(mesh).shortest(mesh.vertex_points[corners] - mesh.cell_points[:, None])
        x, y, _ = np.moveaxis(mesh.cell_points[:, None] + ways, -1, 0)
        return {"x": x, "y": y}
    middle = np.degrees(mesh.lon_cell)[:, None]
    away = np.degrees(mesh.lon_vertex)[corners] - middle
    longitudes = middle + away - 360.0 * np.round(away / 360.0)
    return {"lon": longitudes, "lat": np.degrees(mesh.lat_vertex)[corners]}
