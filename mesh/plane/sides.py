"""Corners and sides of the cells of generators among their images: what of them a mesh of the rectangle keeps.

Where a cell lies at a wall, its side with its own mirror image is its part of the wall. Sides with mirror images of
others have no length, since four generators, two and their images, stand on one circle about each vertex on a wall; so
they are left out, and the two circumcentres beside each are one vertex.
"""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Index
from mesh.coast.corners import COAST, FEWEST_SIDES, Corners, pairs_of_cells, preceding_rows
from mesh.errors import MeshError
from mesh.plane.images import Images
from mesh.plane.moving import PlaneCells

INNER, LEFT_OUT = -1, -2
"""Of a side, in the place of the number of a wall: those are 0, 1 in the west and the east, 2, 3 in south and north."""

NONE = -1


@dataclass(frozen=True, eq=False)
class CellSides:
    """The `corners` of all cells, their places being vertices; and of each vertex its cells and its circumcentre.

    `cells_on_vertex` (n_vertices, 3) are counter-clockwise from the lowest on or, on a wall, the cell that it enters
    there, with the rectangle to its left, and the one that it leaves; where two walls meet there is one cell. `walls`
    (n_vertices, 2) are those in x and in y that each vertex is on, -1 for none. `centers` (n_vertices,) are rows of
    `PlaneCells.circumcenters`, those of inner vertices among others images.
    """

    corners: Corners
    cells_on_vertex: Index
    walls: Index
    centers: Index


def sides_of(cells: PlaneCells) -> CellSides:
    """The sides and corners of the cells of all generators.

    Raises `MeshError` where these are too few for their neighbours to be other cells, each met along one side.
    """
    starts = cells.ring_starts
    n_cells = len(starts) - 1
    cell = np.repeat(np.arange(n_cells, dtype=np.int32), np.diff(starts))
    triangle = cells.rings[: starts[-1]]
    corners = cells.triangles[triangle]
    place = np.argmax(corners == cell[:, None], axis=1)
    # The side that leads from a circumcentre to the next, counter-clockwise round a cell, lies before it in a triangle.
    image = np.take_along_axis(corners, ((place + 2) % 3)[:, None], axis=1)[:, 0]
    neighbour, wall = _told(cells.images, n_cells, cell, image)
    kept = np.flatnonzero(wall != LEFT_OUT)
    cell, neighbour, wall, triangle = cell[kept], neighbour[kept], wall[kept], triangle[kept]
    sizes = np.bincount(cell, minlength=n_cells)
    if sizes.min() < FEWEST_SIDES:
        raise _too_few(f"cell {np.argmin(sizes)} has {sizes.min()} sides")
    starts = np.concatenate([[0], np.cumsum(sizes)])
    before = preceding_rows(starts)
    neighbours = np.where(wall == INNER, neighbour, COAST).astype(np.int32)
    pairs, counts = pairs_of_cells(cell, neighbours, n_cells)
    if counts.max(initial=0) > 1:
        one, other = divmod(int(pairs[np.argmax(counts)]), n_cells)
        raise _too_few(f"cells {one} and {other} meet along two sides")
    around, walls = _vertices(cell, neighbour, wall, before)
    if (np.minimum(wall, wall[before]) >= 0)[wall == wall[before]].any():
        raise _too_few("a cell meets a wall twice")
    keys = np.column_stack([around, walls])
    found, first, vertex = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return CellSides(
        Corners(starts.astype(np.int32), vertex.astype(np.int32).ravel(), neighbours, cell),
        found[:, :3].astype(np.int32),
        found[:, 3:].astype(np.int32),
        triangle[first],
    )


def _told(images: Images, n_cells: int, cell: Index, image: Index) -> tuple[Index, Index]:
    """The cells (n,) across the sides of a `cell` (n,) with an `image` (n,), and their walls, `INNER` or `LEFT_OUT`."""
    beyond = np.flatnonzero(image >= n_cells)
    row = image[beyond] - n_cells
    if row.max(initial=0) >= len(images.numbers):
        raise _too_few("some cell reaches beyond all images of the generators")
    neighbour = image.astype(np.int64)
    neighbour[beyond] = images.numbers[row]
    wall = np.full(len(image), INNER)
    mirrored = images.signs[row] < 0.0
    own = neighbour[beyond] == cell[beyond]
    for axis in range(2):
        other = 1 - axis
        straight = mirrored[:, axis] & ~mirrored[:, other] & (images.shifts[row, other] == 0.0)
        here = np.flatnonzero(own & straight)
        wall[beyond[here]] = 2 * axis + (images.shifts[row[here], axis] > 0.0)
    others = mirrored.any(axis=1) & (wall[beyond] == INNER)
    wall[beyond[others]] = LEFT_OUT
    if ((wall == INNER) & (neighbour == cell)).any():
        raise _too_few("a cell is its own neighbour")
    return neighbour, wall


def _vertices(cell: Index, neighbour: Index, wall: Index, before: Index) -> tuple[Index, Index]:
    """Cells (n, 3) round the vertex at the begin of each side, and the walls (n, 2) that it is on."""
    around = np.column_stack([cell, neighbour[before], neighbour])
    at_wall, after_wall = wall >= 0, wall[before] >= 0
    inner = ~(at_wall | after_wall)
    turn = np.argmin(around, axis=1)[:, None] + np.arange(3)
    turned = np.take_along_axis(around, turn % 3, axis=1)
    # Where its own side comes next, the wall enters the cell; where it was the last, the wall leaves the cell.
    entered = np.where(at_wall, cell, neighbour)
    left = np.where(at_wall, neighbour[before], cell)
    left = np.where(at_wall & after_wall, NONE, left)
    on_wall = np.column_stack([entered, left, np.full(len(cell), NONE)])
    walls = np.full((len(cell), 2), NONE)
    for each in (wall, wall[before]):
        for axis in range(2):
            on = (each >= 0) & (each // 2 == axis)
            walls[on, axis] = each[on]
    return np.where(inner[:, None], turned, on_wall), walls


def _too_few(what: str) -> MeshError:
    return MeshError(f"{what}, so that these generators make no mesh of the plane; give more of them, or a wider plane")
