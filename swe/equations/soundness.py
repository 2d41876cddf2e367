"""What is wrong with a state, in words: thickness and velocity, and thickness at the vertices of obtuse triangles.

Some kites of an obtuse triangle have negative area, so the thickness at its vertex, a kite-weighted mean, can lie
outside the range of the three cells, and can turn negative while all three are positive.
"""

import numpy as np

from mesh.arrays import Array
from mesh.voronoi_mesh import Place, VoronoiMesh
from swe.parallel.processes import ONE_PROCESS, Processes
from swe.state import State

THIN = 0.5
"""A vertex thinner than this fraction of its thinnest cell causes a warning before a run."""


def problem_with_state(mesh: VoronoiMesh, state: State, processes: Processes = ONE_PROCESS) -> str | None:
    """What is wrong with `state`, as the end of a sentence; None if nothing is.

    Entities are told by their numbers in the mesh of all `processes`.
    """
    h, u = state.thickness, state.normal_velocity
    if not np.isfinite(u.sum()):
        edge = int(np.argmax(~np.isfinite(u)))
        return f"normal velocity is {u[edge]:g} m/s at edge {processes.number('edges', edge)} (counted from 0)"
    if h.min() > 0.0 and np.isfinite(h.max()):
        return None
    cell = int(np.argmax(~((h > 0.0) & np.isfinite(h))))
    return (
        f"thickness is {h[cell]:g} m in cell {processes.number('cells', cell)} (counted from 0) "
        f"{_place(mesh, 'cell', cell)}"
    )


def has_negative_kites(mesh: VoronoiMesh) -> bool:
    """Whether thickness at a vertex may lie outside the range of its cells."""
    return bool(mesh.kite_areas_on_vertex.min() < 0.0)


def problem_at_vertices(mesh: VoronoiMesh, thickness: Array, processes: Processes = ONE_PROCESS) -> str | None:
    """Where `thickness` (n_cells,) is not positive at a vertex of this one of the `processes`, in words, or None.

    None also if a cell fails, which is another matter.
    """
    if not (thickness.min() > 0.0 and np.isfinite(thickness.max())):
        return None
    at_vertices = vertex_thickness(mesh, thickness)
    wrong = np.zeros(len(at_vertices), bool)
    own = processes.own.vertices
    wrong[own] = ~(at_vertices[own] > 0.0)
    if not wrong.any():
        return None
    vertex = int(np.argmax(wrong))
    around = ", ".join(f"{value:g}" for value in thickness[mesh.cells_on_vertex[vertex]])
    obtuse = int(np.count_nonzero((mesh.kite_areas_on_vertex < 0.0).any(axis=1)))
    return (
        f"thickness is {at_vertices[vertex]:g} m at vertex {processes.number('vertices', vertex)} (counted from 0) "
        f"{_place(mesh, 'vertex', vertex)}, the corner of cells of {around} m: "
        f"{obtuse} triangles of the mesh are so obtuse that kites are negative; use a mesh without them "
        "(trisk mesh --well-centred)"
    )


def thin_vertices(mesh: VoronoiMesh, thickness: Array, processes: Processes = ONE_PROCESS) -> int:
    """At how many vertices of all `processes` `thickness` is less than `THIN` of that of the thinnest cell around."""
    around = thickness[mesh.cells_on_vertex].min(axis=1)
    thin = vertex_thickness(mesh, thickness) < THIN * around
    return int(processes.sums(np.array([float(np.count_nonzero(thin[processes.own.vertices]))]))[0])


def warning_of_vertices(thin: int) -> str:
    """A warning of so many `thin_vertices`."""
    vertices = "vertex" if thin == 1 else "vertices"
    return (
        f"at {thin} {vertices} of obtuse triangles thickness is less than {THIN:g} of that of the thinnest cell "
        "around, and may turn negative in the course of the run; a mesh without such triangles (trisk mesh "
        "--well-centred) would do"
    )


def vertex_thickness(mesh: VoronoiMesh, thickness: Array) -> Array:
    """Kite-weighted mean of `thickness` (n_cells,) at vertices (n_vertices,), m."""
    return (mesh.kite_areas_on_vertex * thickness[mesh.cells_on_vertex]).sum(axis=1) / mesh.area_triangle


def _place(mesh: VoronoiMesh, kind: Place, number: int) -> str:
    longitude, latitude = (float(values[number]) for values in mesh.coordinates(kind))
    if not mesh.on_a_sphere:
        return f"at x = {longitude:g} and y = {latitude:g} m"
    return f"at longitude {np.degrees(longitude):.1f} and latitude {np.degrees(latitude):.1f} degrees"
