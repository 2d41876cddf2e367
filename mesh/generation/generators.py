"""Starting points on the unit sphere: bisection of the icosahedron, the Fibonacci spiral, and random points."""

from collections.abc import Callable

import numba
import numpy as np

from mesh.arrays import Array, Index, by_blocks
from mesh.density.named import Density, density_at, uniform
from mesh.density.scaling import largest_value, within_range
from mesh.errors import MeshError
from mesh.geometry.sphere import fibonacci_points, normalize
from mesh.mesh_request import MeshRequest
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.half_edges import build_twins

MINIMUM_CELLS, MAXIMUM_CELLS = 12, (2**31 - 1) // 6
STARTS = ("icosahedral", "fibonacci", "random", "random-root")
DEFAULT_SEED = MeshRequest.seed

DENSITY_MARGIN = 1.05
SMALLEST_ACCEPTANCE = 1e-3


def icosahedron() -> Array:
    """Vertices (12, 3) of the regular icosahedron at the cyclic permutations of (0, +-1, +-golden ratio).

    The poles are midpoints of edges. With vertices there, zonal flows would follow the symmetry of the mesh and
    look more accurate than flows along any other axis.
    """
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    vertices = [(0.0, a, b * golden) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    return normalize(np.array([np.roll(vertex, shift) for vertex in vertices for shift in range(3)]))


def bisect(points: Array, triangles: Index) -> tuple[Array, Index, Index]:
    """Insert the midpoint of every side; each triangle becomes four.

    Takes points (n, 3) and closed triangles (m, 3). Returns points (4 n - 6, 3), the old ones first, triangles
    (4 m, 3) of the same orientation, the children of triangle t being 4 t to 4 t + 3, and the two old points
    (3 n - 6, 2) between which each new one lies.
    """
    triangles = np.ascontiguousarray(triangles, dtype=np.int32)
    middles, ends = _middles(triangles, build_twins(triangles, len(points)), len(points))
    between = by_blocks(lambda pair: normalize(points[pair[:, 0]] + points[pair[:, 1]]), ends)
    return np.concatenate([points, between]), _children(triangles, middles), ends


@numba.njit(cache=True)
def _middles(triangles: Index, twins: Index, n_points: int) -> tuple[Index, Index]:
    """Numbers (m, 3) of the middles of sides opposite to corners, from `n_points` on, and the ends of these sides."""
    middles = np.empty_like(triangles)
    ends = np.empty((triangles.size // 2, 2), np.int32)
    count = 0
    for triangle in range(len(triangles)):
        for k in range(3):
            twin = twins[triangle, k]
            if 3 * triangle + k < twin:
                middles[triangle, k] = middles[twin // 3, twin % 3] = n_points + count
                ends[count, 0], ends[count, 1] = triangles[triangle, (k + 1) % 3], triangles[triangle, (k + 2) % 3]
                count += 1
    return middles, ends


@numba.njit(cache=True)
def _children(triangles: Index, middles: Index) -> Index:
    """The four triangles (4 m, 3) of each: those at its three corners, and that of the middles of its sides."""
    children = np.empty((4 * len(triangles), 3), np.int32)
    for triangle in range(len(triangles)):
        for k in range(3):
            for corner in range(3):
                source = triangles if corner == k else middles
                # The child at corner k has, in place of each other corner, the middle of the side that joins both.
                place = k if corner == k else 3 - k - corner
                children[4 * triangle + k, corner] = source[triangle, place]
            children[4 * triangle + 3, k] = middles[triangle, k]
    return children


def refine(points: Array, triangles: Index, cells: int) -> tuple[Array, Index]:
    """Bisect a closed mesh (n points) and divide as many of the new triangles in three as `cells` asks for.

    `cells` lies between 4 n - 6, what bisection gives, and that plus the number of triangles, 2 n - 4. The triangles
    divided are evenly spread over the numbers. Returns points (cells, 3) and triangles between them.
    """
    fine, children, _ = bisect(points, triangles)
    count = cells - len(fine)
    if count == 0:
        return fine, children
    middle = 4 * np.linspace(0, len(triangles), count, endpoint=False).astype(np.int64) + 3
    a, b, c = children[middle].T
    inserted = np.arange(len(fine), cells, dtype=np.int32)
    children[middle, 2] = inserted
    others = np.concatenate([np.stack([b, c, inserted], axis=1), np.stack([c, a, inserted], axis=1)])
    centers = normalize(fine[a] + fine[b] + fine[c])
    return np.concatenate([fine, centers]), np.concatenate([children, others])


def icosahedral_mesh(level: int) -> tuple[Array, Index]:
    """Points (10*4^level + 2, 3) of the icosahedron bisected `level` times and triangles between them.

    Level 0 is the icosahedron itself. The triangles (20*4^level, 3) are the bisected ones, which are Delaunay.
    """
    points = icosahedron()
    triangles = delaunay(points)
    for _ in range(level):
        points, triangles, _ = bisect(points, triangles)
    return points, triangles


def icosahedral_points(level: int) -> Array:
    """Points (10*4^level + 2, 3) of the icosahedron bisected `level` times; those of each level come first."""
    return icosahedral_mesh(level)[0]


def icosahedral_level(cells: int) -> int | None:
    """The bisection level that has this number of cells, or None where there is none."""
    level = 0
    while 10 * 4**level + 2 < cells:
        level += 1
    return level if 10 * 4**level + 2 == cells else None


def random_points(count: int, density: Density, generator: np.random.Generator) -> Array:
    """Points (count, 3) drawn from `density` by rejection with a seeded numpy generator.

    Raises `MeshError` where the density is negative, not finite, or zero nearly everywhere.
    """
    density = within_range(density)
    bound = DENSITY_MARGIN * largest_value(density)

    def propose(size: int) -> Array:
        return normalize(generator.normal(size=(size, 3)))

    return drawn_by_rejection(count, propose, lambda points: density_at(density, points), bound, generator, 0.5)


def drawn_by_rejection(
    count: int,
    propose: Callable[[int], Array],
    weight: Density,
    bound: float,
    generator: np.random.Generator,
    accepted: float,
) -> Array:
    """Points (count, 3) of those that `propose` draws evenly, each kept as likely as its weight is large.

    No weight is larger than `bound`; `accepted` is the part that is kept at a guess.
    """
    drawn: list[Array] = []
    missing = count
    while missing > 0:
        points = propose(int(1.2 * missing / accepted) + 100)
        kept = points[generator.random(len(points)) * bound < weight(points)]
        drawn.append(kept[:missing])
        missing -= len(drawn[-1])
        accepted = max(len(kept) / len(points), SMALLEST_ACCEPTANCE)
    return np.concatenate(drawn)


def starting_points(
    cells: int, start: str | None = None, density: Density = uniform, seed: int = DEFAULT_SEED
) -> Array:
    """Points (cells, 3) to start from, by the name of the `start`.

    `icosahedral` bisection (the default where it has this number of cells), `fibonacci` (the default elsewhere),
    `random` points drawn from the density, or `random-root` ones drawn from its square root, which converge sooner.
    Raises `MeshError` for fewer than 12 cells, an unknown start, or a number the icosahedron does not give.
    """
    if cells < MINIMUM_CELLS:
        raise MeshError(f"a mesh of {cells} cells is too small; ask for at least {MINIMUM_CELLS}")
    if cells > MAXIMUM_CELLS:
        raise MeshError(f"a mesh of {cells} cells has too many half-edges to number; ask for at most {MAXIMUM_CELLS}")
    level = icosahedral_level(cells)
    if start is None:
        start = "fibonacci" if level is None else "icosahedral"
    if start == "fibonacci":
        return fibonacci_points(cells)
    if start == "random":
        return random_points(cells, density, np.random.default_rng(seed))
    if start == "random-root":
        return random_points(cells, lambda points: np.sqrt(density_at(density, points)), np.random.default_rng(seed))
    if start != "icosahedral":
        raise MeshError(f"there is no start named '{start}'; choose one of {', '.join(STARTS)}")
    if level is None:
        below = int(np.log(max(cells - 2, 10) / 10) / np.log(4))
        raise MeshError(
            f"bisection of the icosahedron gives no mesh of {cells} cells; "
            f"choose {10 * 4**below + 2} or {10 * 4 ** (below + 1) + 2}, or start from fibonacci"
        )
    return icosahedral_points(level)
