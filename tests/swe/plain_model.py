"""The equations of DESIGN, section 4, in plain numpy and Python, on the arrays of a mesh file: nothing of ours."""

from pathlib import Path

import netCDF4
import numpy as np

GRAVITY = 9.80616
ROTATION_RATE = 7.292e-5


class PlainMesh:
    """Arrays of an MPAS mesh file under their names there, indices counted from 0."""

    def __init__(self, path: Path) -> None:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            self.arrays = {name: np.asarray(variable[:]) for name, variable in file.variables.items()}
        for name in (
            *("cellsOnEdge", "verticesOnEdge", "cellsOnVertex", "edgesOnVertex"),
            *("edgesOnCell", "verticesOnCell", "cellsOnCell", "edgesOnEdge"),
        ):
            if name in self.arrays:
                self.arrays[name] = self.arrays[name].astype(int) - 1

    def __getattr__(self, name: str) -> np.ndarray:
        return self.arrays[name]

    def edges_of(self, cell: int) -> np.ndarray:
        return self.edgesOnCell[cell, : self.nEdgesOnCell[cell]]

    @property
    def n_cells(self) -> int:
        return len(self.areaCell)

    @property
    def n_vertices(self) -> int:
        return len(self.areaTriangle)

    def cells(self) -> np.ndarray:
        return np.stack([self.xCell, self.yCell, self.zCell], axis=1)


def outflow(mesh: PlainMesh, flux: np.ndarray) -> np.ndarray:
    """Sum over the edges of each cell of what `flux` per length takes away from it."""
    result = np.zeros(mesh.n_cells)
    for (first, second), through in zip(mesh.cellsOnEdge, flux * mesh.dvEdge, strict=True):
        result[first] += through
        result[second] -= through
    return result


def circulation(mesh: PlainMesh, along: np.ndarray) -> np.ndarray:
    """Counter-clockwise integral round each triangle of what acts along the normals of edges."""
    result = np.zeros(mesh.n_vertices)
    for (tail, head), part in zip(mesh.verticesOnEdge, along * mesh.dcEdge, strict=True):
        result[head] += part
        result[tail] -= part
    return result


def difference(mesh: PlainMesh, at_cells: np.ndarray) -> np.ndarray:
    """Value in the cell that the normal enters less that in the cell that it leaves."""
    return at_cells[mesh.cellsOnEdge[:, 1]] - at_cells[mesh.cellsOnEdge[:, 0]]


def kinetic_energy(mesh: PlainMesh, u: np.ndarray) -> np.ndarray:
    quarter = 0.25 * mesh.dcEdge * mesh.dvEdge * u**2
    return np.array([quarter[mesh.edges_of(cell)].sum() for cell in range(mesh.n_cells)]) / mesh.areaCell


def relative_vorticity(mesh: PlainMesh, u: np.ndarray) -> np.ndarray:
    return circulation(mesh, u) / mesh.areaTriangle


def thickness_at_vertices(mesh: PlainMesh, h: np.ndarray) -> np.ndarray:
    return (mesh.kiteAreasOnVertex * h[mesh.cellsOnVertex]).sum(axis=1) / mesh.areaTriangle


def coriolis(mesh: PlainMesh) -> np.ndarray:
    """Of rotation about the polar axis, at vertices."""
    return 2.0 * ROTATION_RATE * np.sin(mesh.latVertex)


def potential_vorticity(mesh: PlainMesh, h: np.ndarray, u: np.ndarray) -> np.ndarray:
    return (coriolis(mesh) + relative_vorticity(mesh, u)) / thickness_at_vertices(mesh, h)


def tangential(mesh: PlainMesh, along: np.ndarray) -> np.ndarray:
    """Sum of the weights of each edge times values at other edges."""
    return (weights(mesh) * along[np.maximum(mesh.edgesOnEdge, 0)]).sum(axis=1)


def weights(mesh: PlainMesh) -> np.ndarray:
    return np.where(np.arange(mesh.edgesOnEdge.shape[1]) < mesh.nEdgesOnEdge[:, None], mesh.weightsOnEdge, 0.0)


def mean_on_cells(mesh: PlainMesh, at_vertices: np.ndarray) -> np.ndarray:
    """Mean of values at vertices under the areas of the kites of each cell."""
    total = np.zeros(mesh.n_cells)
    np.add.at(total, mesh.cellsOnVertex, mesh.kiteAreasOnVertex * at_vertices[:, None])
    return total / mesh.areaCell


def flux(mesh: PlainMesh, h: np.ndarray, u: np.ndarray) -> np.ndarray:
    return h[mesh.cellsOnEdge].mean(axis=1) * u


def coriolis_force(mesh: PlainMesh, F: np.ndarray, q_edge: np.ndarray) -> np.ndarray:
    means = 0.5 * (q_edge[:, None] + q_edge[np.maximum(mesh.edgesOnEdge, 0)])
    return (weights(mesh) * F[np.maximum(mesh.edgesOnEdge, 0)] * means).sum(axis=1)


def anticipated(mesh: PlainMesh, u: np.ndarray, q: np.ndarray, seconds: float) -> np.ndarray:
    """What the anticipation takes from q at edges: seconds times u . grad q, with the sign of an addition."""
    across = difference(mesh, mean_on_cells(mesh, q)) / mesh.dcEdge
    along = (q[mesh.verticesOnEdge[:, 1]] - q[mesh.verticesOnEdge[:, 0]]) / mesh.dvEdge
    return -seconds * (u * across + tangential(mesh, u) * along)


def laplacian(mesh: PlainMesh, u: np.ndarray) -> np.ndarray:
    """grad div u + k x grad zeta along the normals."""
    divergence = outflow(mesh, u) / mesh.areaCell
    zeta = relative_vorticity(mesh, u)
    slope = zeta[mesh.verticesOnEdge[:, 1]] - zeta[mesh.verticesOnEdge[:, 0]]
    return difference(mesh, divergence) / mesh.dcEdge - slope / mesh.dvEdge


def velocity_at_cells(mesh: PlainMesh, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eastward and northward, by least squares over the unit chords seen in the tangent plane of each cell."""
    points = mesh.cells() / np.linalg.norm(mesh.cells(), axis=1)[:, None]
    found = np.empty((mesh.n_cells, 2))
    for cell, point in enumerate(points):
        edges = mesh.edges_of(cell)
        ends = points[mesh.cellsOnEdge[edges]]
        chord = ends[:, 1] - ends[:, 0]
        east = np.array([-np.sin(mesh.lonCell[cell]), np.cos(mesh.lonCell[cell]), 0.0])
        design = chord @ np.stack([east, np.cross(point, east)], axis=1)
        design /= np.linalg.norm(chord, axis=1)[:, None]
        found[cell] = np.linalg.lstsq(design, u[edges], rcond=None)[0]
    return found[:, 0], found[:, 1]
