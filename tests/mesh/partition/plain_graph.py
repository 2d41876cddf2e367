"""Pieces, halos and edges between blocks by plain loops over sets."""

from mesh import VoronoiMesh
from mesh.arrays import Index

Neighbours = list[set[int]]


def plain_neighbours(mesh: VoronoiMesh) -> Neighbours:
    """The neighbours of each cell, by the edges."""
    neighbours: Neighbours = [set() for _ in range(mesh.n_cells)]
    for one, other in mesh.cells_on_edge.tolist():
        if one >= 0 and other >= 0:
            neighbours[one].add(other)
            neighbours[other].add(one)
    return neighbours


def is_connected(neighbours: Neighbours, cells: set[int]) -> bool:
    """Whether one can go from any cell to any other without leaving `cells`; not where there are none."""
    if not cells:
        return False
    reached, front = set(), {min(cells)}
    while front:
        reached |= front
        front = {other for cell in front for other in neighbours[cell]} & cells - reached
    return reached == cells


def cells_by_block(blocks: Index, n_blocks: int) -> list[set[int]]:
    """The cells of each block."""
    cells: list[set[int]] = [set() for _ in range(n_blocks)]
    for cell, block in enumerate(blocks.tolist()):
        cells[block].add(cell)
    return cells


def plain_halo(neighbours: Neighbours, cells: set[int], rings: int) -> list[set[int]]:
    """The cells of each ring round `cells`."""
    within, halo = set(cells), []
    for _ in range(rings):
        ring = {other for cell in within for other in neighbours[cell]} - within
        within |= ring
        halo.append(ring)
    return halo
