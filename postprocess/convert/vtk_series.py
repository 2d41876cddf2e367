"""A run as two series of VTK files in a folder: cells with values at vertices too, and edges."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mesh.arrays import Index
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.convert.contents import Contents
from postprocess.convert.images import whole_points
from postprocess.convert.vtu import LINE, POLYGON, Grid, Values, write_series, write_vtu
from postprocess.convert.whole_folder import folder_aside
from postprocess.runs.reading import Progress, Snapshot
from swe.diagnostics.outputs import CELLS, EDGES, VERTICES
from swe.errors import RunError

CELL_SERIES, EDGE_SERIES = "cells", "edges"

PATTERNS = ("*.vtu", f"{CELL_SERIES}.pvd", f"{EDGE_SERIES}.pvd")
"""Files that a folder of series holds."""


@dataclass(frozen=True, eq=False)
class _Series:
    """Files of one grid, the vertex at each of its points, and the places whose fields are at its cells and points."""

    name: str
    grid: Grid
    sources: Index
    at_cells: str
    at_points: str
    files: list[str] = field(default_factory=list)

    def add(self, folder: Path, contents: Contents, snapshot: Snapshot) -> None:
        """Write the file of a snapshot."""
        name = f"{self.name}_{len(self.files):05d}.vtu"
        at_cells = _values_at(self.at_cells, contents, snapshot)
        at_points = _values_at(self.at_points, contents, snapshot, self.sources)
        write_vtu(folder / name, self.grid, at_cells, at_points, snapshot.day)
        self.files.append(name)


def write_vtk(contents: Contents, folder: Path, _: str, progress: Progress) -> list[Path]:
    """Write all snapshots to `folder`, which appears when it is whole; return the files that name those of each series.

    Raises `RunError` where they cannot be written.
    """
    mesh, days = contents.run.mesh, contents.run.days
    series = [_Series(CELL_SERIES, *cell_grid(mesh), CELLS, VERTICES)]
    if any(each.place == EDGES for each in contents.fields.values()):
        series.append(_Series(EDGE_SERIES, *edge_grid(mesh), EDGES, ""))
    try:
        with folder_aside(folder, PATTERNS) as aside:
            for _number, snapshot in contents.snapshots(progress):
                for each in series:
                    each.add(aside, contents, snapshot)
            for each in series:
                write_series(aside / f"{each.name}.pvd", each.files, days.tolist())
    except OSError as error:
        raise RunError(f"{folder} cannot be written ({error}); is the disk full?") from error
    return [folder / f"{each.name}.pvd" for each in series]


def cell_grid(mesh: VoronoiMesh) -> tuple[Grid, Index]:
    """Voronoi cells as polygons, counter-clockwise from outside, and the vertex (n_points,) at each point.

    Points are the vertices and, where a plane repeats itself, their images beyond its seams.
    """
    centers = np.repeat(mesh.cell_points, mesh.n_edges_on_cell, axis=0)
    points, sources, corners = whole_points(mesh, mesh.vertices_on_cell[mesh.on_ring], centers)
    return Grid(points, corners, np.cumsum(mesh.n_edges_on_cell, dtype=np.int64), POLYGON), sources


def edge_grid(mesh: VoronoiMesh) -> tuple[Grid, Index]:
    """Edges as lines between vertices, along the tangent, and the vertex at each point; see `cell_grid`."""
    tails = np.repeat(mesh.vertex_points[mesh.vertices_on_edge[:, 0]], 2, axis=0)
    points, sources, corners = whole_points(mesh, mesh.vertices_on_edge.reshape(-1), tails)
    return Grid(points, corners, np.arange(2, 2 * mesh.n_edges + 1, 2, dtype=np.int64), LINE), sources


def _values_at(place: str, contents: Contents, snapshot: Snapshot, sources: Index | None = None) -> dict[str, Values]:
    """Fields at a place by name; with `sources`, the values (n_points,) of these entities."""
    values = {name: (each, fixed) for name, (each, fixed) in contents.fixed.items() if each.place == place}
    values |= {name: (each, snapshot.fields[name]) for name, each in contents.fields.items() if each.place == place}
    return {
        name: Values(found if sources is None else found[sources], each.units) for name, (each, found) in values.items()
    }
