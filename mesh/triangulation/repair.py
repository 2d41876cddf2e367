"""Kernels that keep a spherical Delaunay triangulation while its points move, by edge flips.

The side between triangles (a, b, c) and (b, a, d) is not Delaunay where d lies above the plane of a, b, c. The height
of d is compared with `HEIGHT_TOLERANCE`: rounding of coordinates moves points off the sphere by about one unit in the
last place, 1.1e-16, whatever their spacing, so that heights below a few such units mean nothing; the arithmetic adds
only 1e-16 times the local spacing, because differences of points come first. Every flip thus enlarges the volume of
the polyhedron by more than round-off, and no chain of flips returns to where it began, even for points on one circle.

Half-edges are numbered as `mesh.triangulation.half_edges` says. Names: a and b are the ends of a side, c the corner of
its triangle t, d that of the neighbour u across.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.vectors import Vector, cross_product, dot_product, triangle_normal, vector_between, vector_to

HEIGHT_TOLERANCE = 1.0e-15
"""Height over a triangle's plane, in radii, above which a corner calls for a flip: a few units in the last place."""

COVERING_HEIGHT = 1e-10
"""Height over the plane of a triangle, in radii, above which a point is well inside its circle."""

ARITHMETIC_TOLERANCE = 16 * 2.2e-16
"""Rounding error of a determinant, relative to the product of its vectors' lengths."""

TRIANGLE_BLOCK = 2048
"""Triangles that one thread looks at in one go."""

SIDES, INVERTED = 7, 8
"""Bits of a mark: of the three sides that are not Delaunay, and of an inverted or flat triangle."""

STACK_SIZE = 1 << 16
FLIPS_PER_POINT = 30
"""More flips than this many times the number of points mean that they do not settle."""


@numba.njit(cache=True)
def _volume(points: Array, a: int, normal: Vector) -> float:
    """The product a.normal, that is det(a, b, c): positive for a well oriented triangle."""
    return dot_product(vector_to(points, a), normal)


@numba.njit(cache=True)
def _place_circumcenter(points: Array, triangles: Index, triangle: int, circumcenters: Array) -> bool:
    """Write the circumcentre of one triangle; False if it is inverted or flat."""
    a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
    normal = triangle_normal(points, a, b, c)
    factor = 1.0 / np.sqrt(dot_product(normal, normal))
    circumcenters[triangle, 0] = normal[0] * factor
    circumcenters[triangle, 1] = normal[1] * factor
    circumcenters[triangle, 2] = normal[2] * factor
    return _volume(points, a, normal) > 0.0


@numba.njit(parallel=True, cache=True)
def count_covers(points: Array, triangles: Index, circumcenters: Array, probes: Index) -> int:
    """Number of triangles whose circle has one of the points `probes`, none of its corners, well inside."""
    count = 0
    for triangle in numba.prange(len(triangles)):
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        for p in probes:
            if p != a and p != b and p != c:
                height = 0.0
                for k in range(3):
                    height += circumcenters[triangle, k] * (points[p, k] - points[a, k])
                if height > COVERING_HEIGHT:
                    count += 1
    return count


@numba.njit(parallel=True, cache=True, error_model="numpy")
def survey(
    points: Array,
    triangles: Index,
    twins: Index,
    circumcenters: Array,
    marks: Index,
    violations: Index,
    inversions: Index,
) -> None:
    """Compute the circumcentres (m, 3) of all triangles and check every edge.

    marks (m,) uint8 gets bit k set where the side opposite to corner k breaks
    the Delaunay property (each edge is seen once, from the smaller half-edge),
    and bit 3 (INVERTED) where the triangle is inverted or flat.
    violations and inversions (number of blocks,) int64 count per block.
    """
    number_of_triangles = len(triangles)
    corners = triangles.ravel()
    for block in numba.prange(len(violations)):
        found = 0
        inverted = 0
        for triangle in range(block * TRIANGLE_BLOCK, min((block + 1) * TRIANGLE_BLOCK, number_of_triangles)):
            mark = 0
            if not _place_circumcenter(points, triangles, triangle, circumcenters):
                inverted += 1
                mark = INVERTED
            a = triangles[triangle, 0]
            for k in range(3):
                twin = twins[triangle, k]
                if 3 * triangle + k < twin:
                    d = corners[twin]
                    height = (
                        circumcenters[triangle, 0] * (points[d, 0] - points[a, 0])
                        + circumcenters[triangle, 1] * (points[d, 1] - points[a, 1])
                        + circumcenters[triangle, 2] * (points[d, 2] - points[a, 2])
                    )
                    if height > HEIGHT_TOLERANCE:
                        mark |= 1 << k
                        found += 1
            marks[triangle] = mark
        violations[block] = found
        inversions[block] = inverted


@numba.njit(cache=True)
def _opens_well(points: Array, a: int, b: int, c: int, d: int) -> bool:
    """True where both triangles (c, a, d) and (d, b, c) are positively oriented."""
    return (
        _volume(points, c, triangle_normal(points, c, a, d)) > 0.0
        and _volume(points, d, triangle_normal(points, d, b, c)) > 0.0
    )


@numba.njit(cache=True)
def _must_flip(points: Array, a: int, b: int, c: int, d: int) -> bool:
    """Whether d is above the plane a, b, c beyond round-off, and both new triangles are positively oriented."""
    to_b = vector_between(points, a, points, b)
    to_c = vector_between(points, a, points, c)
    to_d = vector_between(points, a, points, d)
    normal = cross_product(to_b, to_c)
    determinant = dot_product(normal, to_d)
    if not determinant > 0.0:
        return False
    lengths = np.sqrt(dot_product(to_b, to_b) * dot_product(to_c, to_c) * dot_product(to_d, to_d))
    allowed = HEIGHT_TOLERANCE * np.sqrt(dot_product(normal, normal)) + ARITHMETIC_TOLERANCE * lengths
    if determinant <= allowed:
        return False
    return _opens_well(points, a, b, c, d)


@numba.njit(cache=True)
def _join(twins: Index, half_edge: int, twin: int) -> None:
    """Make two half-edges each other's twins."""
    twins[half_edge] = twin
    twins[twin] = half_edge


@numba.njit(cache=True)
def flip(triangles: Index, twins: Index, first_corner: Index, degrees: Index, half_edge: int, twin: int) -> None:
    """Turn the edge of two triangles t, u into the other diagonal (in place).

    Before: t = (c, a, b), u = (d, b, a).  After: t = (c, a, d), u = (d, b, c).
    """
    t, k = half_edge // 3, half_edge % 3
    u, j = twin // 3, twin % 3
    a, b = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
    c, d = triangles[t, k], triangles[u, j]
    flat = twins.ravel()
    beyond_bc, beyond_ca = flat[3 * t + (k + 1) % 3], flat[3 * t + (k + 2) % 3]
    beyond_ad, beyond_db = flat[3 * u + (j + 1) % 3], flat[3 * u + (j + 2) % 3]
    triangles[t, 0], triangles[t, 1], triangles[t, 2] = c, a, d
    triangles[u, 0], triangles[u, 1], triangles[u, 2] = d, b, c
    _join(flat, 3 * t, beyond_ad)
    _join(flat, 3 * t + 1, 3 * u + 1)
    _join(flat, 3 * t + 2, beyond_ca)
    _join(flat, 3 * u, beyond_bc)
    _join(flat, 3 * u + 2, beyond_db)
    first_corner[c], first_corner[a] = 3 * t, 3 * t + 1
    first_corner[d], first_corner[b] = 3 * u, 3 * u + 1
    degrees[a] -= 1
    degrees[b] -= 1
    degrees[c] += 1
    degrees[d] += 1


@numba.njit(cache=True)
def _settle_edge(
    points: Array,
    triangles: Index,
    twins: Index,
    first_corner: Index,
    degrees: Index,
    circumcenters: Array,
    start: int,
    stack: Index,
    limit: int,
) -> int:
    """Lawson flips from one half-edge until all edges near it are Delaunay.

    Returns the flips made, or -1 beyond the limit or the size of the stack.
    """
    flips = 0
    height = 1
    stack[0] = start
    corners = triangles.ravel()
    flat_twins = twins.ravel()
    while height > 0:
        height -= 1
        half_edge = stack[height]
        twin = flat_twins[half_edge]
        t, k = half_edge // 3, half_edge % 3
        a, b = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
        if not _must_flip(points, a, b, corners[half_edge], corners[twin]):
            continue
        if flips >= limit or height + 4 > len(stack):
            return -1
        u = twin // 3
        flip(triangles, twins, first_corner, degrees, half_edge, twin)
        _place_circumcenter(points, triangles, t, circumcenters)
        _place_circumcenter(points, triangles, u, circumcenters)
        flips += 1
        stack[height], stack[height + 1] = 3 * t, 3 * t + 2
        stack[height + 2], stack[height + 3] = 3 * u, 3 * u + 2
        height += 4
    return flips


@numba.njit(cache=True)
def _marked(marks: Index, counts: Index, bits: int) -> Index:
    """Triangles, in order, whose mark has one of the `bits`; `counts` has the number of marks in each block."""
    found = np.empty(min(counts.sum(), len(marks)), np.int64)
    number = 0
    for block in range(len(counts)):
        if counts[block] == 0:
            continue
        for triangle in range(block * TRIANGLE_BLOCK, min((block + 1) * TRIANGLE_BLOCK, len(marks))):
            if marks[triangle] & bits:
                found[number] = triangle
                number += 1
    return found[:number]


@numba.njit(cache=True, error_model="numpy")
def flip_marked(
    points: Array,
    triangles: Index,
    twins: Index,
    first_corner: Index,
    degrees: Index,
    circumcenters: Array,
    marks: Index,
    violations: Index,
) -> int:
    """Serial Lawson loop over the marked edges, in order of the triangles.

    Returns the number of flips, or -1 when they do not settle.
    """
    stack = np.empty(STACK_SIZE, np.int32)
    limit = 1000 + FLIPS_PER_POINT * len(points)
    arrays = (points, triangles, twins, first_corner, degrees, circumcenters)
    flips = 0
    for triangle in _marked(marks, violations, SIDES):
        for k in range(3):
            if marks[triangle] & (1 << k):
                made = _settle_edge(*arrays, 3 * triangle + k, stack, limit - flips)
                if made < 0:
                    return -1
                flips += made
    return flips


@numba.njit(cache=True, error_model="numpy")
def untangle(
    points: Array, triangles: Index, twins: Index, first_corner: Index, degrees: Index, marks: Index, inversions: Index
) -> int:
    """Flip a side of each inverted triangle where that leaves two good ones.

    A point that has just crossed the opposite side of its triangle is set right by turning that side. Serial, in order
    of the triangles; returns the number of flips.
    """
    flips = 0
    corners = triangles.ravel()
    for triangle in _marked(marks, inversions, INVERTED):
        for k in range(3):
            a, b = triangles[triangle, (k + 1) % 3], triangles[triangle, (k + 2) % 3]
            c, twin = triangles[triangle, k], twins[triangle, k]
            if (
                _volume(points, c, triangle_normal(points, c, a, b)) <= 0.0
                and degrees[a] > 3
                and degrees[b] > 3
                and _opens_well(points, a, b, c, corners[twin])
            ):
                flip(triangles, twins, first_corner, degrees, 3 * triangle + k, twin)
                flips += 1
                break
    return flips
