"""What can be had from the file of a validated mesh without its being in memory: parts, its hash, a copy of other size.

All of it is, bit for bit, what the mesh in memory gives. Only `scaled_hash_of_file` checks that the arrays are those of
the stamp; the others take them as they are, and raise `mesh.files.stamped_file.NotValidatedError` where there is none.
"""

from pathlib import Path

import numpy as np

from mesh.arrays import Index
from mesh.conventions import MESH_VARIABLES
from mesh.files.io import hash_of_surface, write_arrays
from mesh.files.stamped_file import NotValidatedError, StampedFile, opened_stamped_file
from mesh.geometry.sphere import normalize
from mesh.geometry.surface import surface_of
from mesh.partition.curve import blocks_along_curve
from mesh.parts.mesh_part import MeshPart, part_of_rows
from mesh.safe_files import AnyPath
from mesh.triangulation.ordering import hilbert_keys


def read_part(path: AnyPath, blocks: Index, block: int, rings: int) -> MeshPart:
    """`mesh.parts.mesh_part.cut_part` of the mesh in a file, of which no more than the part is in memory.

    `blocks` (n_cells,) is the block of every cell. Raises `MeshError` if no cell belongs to `block`, and where the file
    has no stamp or cannot be read.
    """
    with opened_stamped_file(path) as whole:
        return part_of_rows(whole, blocks, block, rings)


def read_blocks_along_curve(path: AnyPath, count: int) -> Index:
    """The `count` blocks that `mesh.partition.curve.blocks_along_curve` makes of a mesh in a file, read slab by slab.

    Raises `MeshError` where there are fewer cells, and where the file has no stamp or cannot be read.
    """
    with opened_stamped_file(path) as mesh:
        return blocks_along_curve(_curve_keys(mesh), mesh.slabs("cells_on_edge"), count)


def _curve_keys(mesh: StampedFile) -> Index:
    """Places (n_cells,) of the cells along a curve; those of a plane, which is never so large, in one piece."""
    axes = (mesh.slabs(name) for name in ("x_cell", "y_cell", "z_cell"))
    slabs = (np.stack(points, axis=1) for points in zip(*axes, strict=True))
    if mesh.sphere_radius == 0.0:
        return hilbert_keys(surface_of(mesh).curve_places(np.concatenate(list(slabs))))
    return np.concatenate([hilbert_keys(normalize(points)) for points in slabs])


def scaled_hash_of_file(path: AnyPath, radius: float) -> str | None:
    """`mesh_hash` of the mesh in a file after `scaled(radius)`; None unless the file holds what its stamp says.

    Reads the file once. Raises `MeshError` where that fails.
    """
    try:
        with opened_stamped_file(path) as mesh:
            scaled = mesh.scaled(radius)
            as_it_is, as_scaled = (hash_of_surface(each) for each in (mesh, scaled))
            for variable in MESH_VARIABLES:
                for values in mesh.slabs(variable.name):
                    as_it_is.update(values.reshape(-1).data)
                    as_scaled.update(scaled.rescale(variable.name, values).reshape(-1).data)
            return as_scaled.hexdigest() if as_it_is.hexdigest() == mesh.stamp else None
    except NotValidatedError:
        return None


def write_scaled_copy(
    path: AnyPath, target: AnyPath, radius: float, scaled_hash: str, history: str = "", file_format: str = "netcdf4"
) -> None:
    """Write what `write_mesh` does of the mesh in a file after `scaled(radius)`, stamped, slab by slab.

    `scaled_hash` is what `scaled_hash_of_file` gives for that radius. Raises `MeshError` where the file has no stamp or
    cannot be read, or where the copy cannot be written.
    """
    with opened_stamped_file(path) as mesh:
        scaled = mesh.scaled(radius)
        write_arrays(scaled, scaled.slabs, Path(target), history, file_format, scaled_hash, validated=True)
