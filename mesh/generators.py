"""Starting points on the unit sphere: recursive bisection of the icosahedron, and the Fibonacci spiral."""

import numpy as np

from mesh.arrays import Array, Index
from mesh.delaunay import delaunay, half_edge_twins
from mesh.errors import MeshError
from mesh.sphere import normalize

MINIMUM_CELLS = 12


def icosahedron() -> Array:
    """Vertices (12, 3) of the regular icosahedron at the cyclic permutations of (0, +-1, +-golden ratio).

    The poles are midpoints of edges. With vertices there, zonal flows would follow the symmetry of the mesh and
    look more accurate than flows along any other axis.
    """
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    vertices = [(0.0, a, b * golden) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    return normalize(np.array([np.roll(vertex, shift) for vertex in vertices for shift in range(3)]))


def bisect(points: Array, triangles: Index) -> tuple[Array, Index]:
    """Insert the midpoint of every side; each triangle becomes four.

    Takes points (n, 3) and closed triangles (m, 3); returns points (n + 3 m / 2, 3), the old ones first, and
    triangles (4 m, 3) of the same orientation.
    """
    twins = half_edge_twins(triangles)
    half_edges = np.arange(3 * len(triangles))
    owner = half_edges < twins
    a = triangles.ravel()
    b = np.roll(triangles, -1, axis=1).ravel()
    middle = np.empty(len(half_edges), dtype=np.int32)
    middle[owner] = len(points) + np.arange(np.count_nonzero(owner), dtype=np.int32)
    middle[~owner] = middle[twins[~owner]]
    refined = np.concatenate([points, normalize(points[a[owner]] + points[b[owner]])])
    ab, bc, ca = middle.reshape(-1, 3).T
    corner_a, corner_b, corner_c = triangles.T
    children = [(corner_a, ab, ca), (corner_b, bc, ab), (corner_c, ca, bc), (ab, bc, ca)]
    return refined, np.stack([np.stack(child, axis=1) for child in children], axis=1).reshape(-1, 3)


def icosahedral_points(level: int) -> Array:
    """Points (10*4^level + 2, 3) of the icosahedron bisected `level` times; level 0 is the icosahedron itself."""
    points = icosahedron()
    triangles = delaunay(points)
    for _ in range(level):
        points, triangles = bisect(points, triangles)
    return points


def icosahedral_level(cells: int) -> int | None:
    """The bisection level that has this number of cells, or None where there is none."""
    level = 0
    while 10 * 4**level + 2 < cells:
        level += 1
    return level if 10 * 4**level + 2 == cells else None


def fibonacci_points(count: int) -> Array:
    """Points (count, 3) on the Fibonacci spiral (Swinbank and Purser 2006): nearly uniform for any number."""
    index = np.arange(count)
    z = 1.0 - (2.0 * index + 1.0) / count
    longitude = index * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(longitude), radius * np.sin(longitude), z], axis=1)


def starting_points(cells: int, start: str | None = None) -> Array:
    """Points (cells, 3) to start from: `icosahedral` or `fibonacci`; by default the first where it exists.

    Raises `MeshError` for fewer than 12 cells, an unknown start, or a number the icosahedron does not give.
    """
    if cells < MINIMUM_CELLS:
        raise MeshError(f"a mesh of {cells} cells is too small; ask for at least {MINIMUM_CELLS}")
    level = icosahedral_level(cells)
    if start is None:
        start = "fibonacci" if level is None else "icosahedral"
    if start == "fibonacci":
        return fibonacci_points(cells)
    if start != "icosahedral":
        raise MeshError(f"there is no start named '{start}'; choose icosahedral or fibonacci")
    if level is None:
        below = int(np.log(max(cells - 2, 10) / 10) / np.log(4))
        raise MeshError(
            f"bisection of the icosahedron gives no mesh of {cells} cells; "
            f"choose {10 * 4**below + 2} or {10 * 4 ** (below + 1) + 2}, or start from fibonacci"
        )
    return icosahedral_points(level)
