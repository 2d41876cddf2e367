"""Culled mesh files as the tools of the MPAS community make them, from the arrays of a file alone, with numbers from 1.

Facts of the format: entities keep their order and rings their places, with 0 where something is gone; an edge with one
cell has it first, and its vertices follow; lengths, angles, the number of edges of a tangent and all weights stay as
they were; rings have room for the widest cell that is kept. Kites of missing cells are zero, and the area of a
triangle is the sum of the others.
"""

from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

RENUMBERED = {
    **dict.fromkeys(("cellsOnCell", "cellsOnEdge", "cellsOnVertex"), "nCells"),
    **dict.fromkeys(("edgesOnCell", "edgesOnEdge", "edgesOnVertex"), "nEdges"),
    **dict.fromkeys(("verticesOnCell", "verticesOnEdge"), "nVertices"),
}


def cull_file(source: Path, target: Path, keep: NDArray[np.bool_]) -> None:
    """Write the cells that `keep` (nCells,) marks of the mesh file `source` to a classic file `target`."""
    with netCDF4.Dataset(source) as file:
        file.set_auto_mask(False)
        arrays = {name: file[name][:] for name in file.variables if file[name].dimensions}
        dimensions = {name: file[name].dimensions for name in arrays}
        attributes = {name: getattr(file, name) for name in ("on_a_sphere", "sphere_radius", "is_periodic")}
    culled, sizes = culled_arrays(arrays, keep)
    with netCDF4.Dataset(target, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.setncatts({**attributes, "mesh_spec": "1.0", "Conventions": "MPAS"})
        for name, values in culled.items():
            for dimension, size in zip(dimensions[name], values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, sizes.get(dimension, size))
            file.createVariable(name, values.dtype, dimensions[name])[:] = values


def culled_arrays(arrays: dict[str, NDArray], keep: NDArray[np.bool_]) -> tuple[dict[str, NDArray], dict[str, int]]:
    """What is left of the arrays of a file, by their names in it, and of the numbers of entities."""
    vertices = np.append(False, keep)[arrays["cellsOnVertex"]].any(axis=1)
    edges = np.append(False, keep)[arrays["cellsOnEdge"]].any(axis=1)
    kept = {"nCells": keep, "nEdges": edges, "nVertices": vertices}
    number = {name: np.append(0, np.where(marks, np.cumsum(marks), 0)) for name, marks in kept.items()}
    rows = {len(marks): marks for marks in kept.values()}
    culled = {name: values[rows[len(values)]] for name, values in arrays.items() if len(values) in rows}
    for name in ("boundaryVertex", "indexToCellID", "indexToEdgeID", "indexToVertexID"):
        del culled[name]
    for name, of in RENUMBERED.items():
        culled[name] = number[of][culled[name]].astype(np.int32)
    alone = culled["cellsOnEdge"][:, 0] == 0
    for name in ("cellsOnEdge", "verticesOnEdge"):
        culled[name][alone] = culled[name][alone][:, ::-1]
    culled["kiteAreasOnVertex"] = np.where(culled["cellsOnVertex"] == 0, 0.0, culled["kiteAreasOnVertex"])
    culled["areaTriangle"] = culled["kiteAreasOnVertex"].sum(axis=1)
    width = int(culled["nEdgesOnCell"].max())
    for name in ("cellsOnCell", "edgesOnCell", "verticesOnCell"):
        culled[name] = culled[name][:, :width]
    for name in ("edgesOnEdge", "weightsOnEdge"):
        culled[name] = culled[name][:, : 2 * width]
    return culled, {name: int(marks.sum()) for name, marks in kept.items()}
