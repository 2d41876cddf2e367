"""Patches of the sphere: the faces of a cube round it, each cut into squares, found from a direction at once.

Patches are numbered by axis (x, y, z) and side (negative, positive) of the face, then by row and column; columns go
along the axis after that of the face, and rows along the next one.
"""

import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.sphere import normalize
from mesh.geometry.vectors import compiled


def points_on_faces(along: Array) -> Array:
    """Unit vectors (6 * k^2, 3) at all pairs of the coordinates `along` (k,) in [-1, 1] of all faces."""
    size = len(along)
    second, first = np.meshgrid(along, along, indexing="ij")
    points = np.empty((3, 2, size, size, 3))
    for axis in range(3):
        for side in range(2):
            points[axis, side, :, :, axis] = 2.0 * side - 1.0
            points[axis, side, :, :, (axis + 1) % 3] = first
            points[axis, side, :, :, (axis + 2) % 3] = second
    return normalize(points.reshape(-1, 3))


def points_in_patches(patches: Index, resolution: int, places: Array) -> Array:
    """Unit vectors (n, k, k, 3) in patches (n,), at all pairs of `places` (k,) from 0 to 1: rows, then columns."""
    face, square = np.divmod(patches, resolution**2)
    row, column = np.divmod(square, resolution)
    shape = (len(patches), len(places), len(places))
    points = np.empty((*shape, 3))
    axis = face // 2
    second = np.broadcast_to(_along(row, places, resolution)[:, :, None], shape)
    first = np.broadcast_to(_along(column, places, resolution)[:, None, :], shape)
    which = np.arange(len(patches))
    points[which, :, :, axis] = (2.0 * (face % 2) - 1.0)[:, None, None]
    points[which, :, :, (axis + 1) % 3] = first
    points[which, :, :, (axis + 2) % 3] = second
    return normalize(points.reshape(-1, 3)).reshape(points.shape)


def _along(number: Index, places: Array, resolution: int) -> Array:
    """Coordinates (n, k) in [-1, 1] of places (k,) in rows or columns (n,)."""
    return (number[:, None] + places) * (2.0 / resolution) - 1.0


def patch_centers(resolution: int) -> Array:
    """Centres (6 * resolution^2, 3) of all patches, in the order of their numbers."""
    return points_on_faces((np.arange(resolution) + 0.5) * 2.0 / resolution - 1.0)


@compiled
def place_in_patch(x: float, y: float, z: float, resolution: int) -> tuple[int, float, float]:
    """Number of the patch that holds a direction, and how far along its columns and rows that lies, from 0 to 1."""
    if abs(x) >= abs(y) and abs(x) >= abs(z):
        axis, major, first, second = 0, x, y, z
    elif abs(y) >= abs(z):
        axis, major, first, second = 1, y, z, x
    else:
        axis, major, first, second = 2, z, x, y
    size = abs(major)
    across, up = 0.5 * resolution * (first / size + 1.0), 0.5 * resolution * (second / size + 1.0)
    column, row = min(int(across), resolution - 1), min(int(up), resolution - 1)
    face = 2 * axis + (1 if major > 0.0 else 0)
    return (face * resolution + row) * resolution + column, across - column, up - row


@compiled
def patch_of(x: float, y: float, z: float, resolution: int) -> int:
    """Number of the patch that holds a direction."""
    return place_in_patch(x, y, z, resolution)[0]
