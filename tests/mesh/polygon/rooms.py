"""Polygons that tests fill, metres, within a plane of 1000 km by 1000 km."""

import numpy as np

from mesh import MeshRequest
from mesh.arrays import Array
from mesh.plane.domain import Rectangle

SIDE = 1e6
PLANE = Rectangle(SIDE, SIDE, "none")
CORNERS = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]


def circle(points: int, radius: float) -> Array:
    """Points (n + 1, 2) of a circle about the middle, closed."""
    angle = 2.0 * np.pi * np.arange(points + 1) / points
    ring = 0.5 * SIDE + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    ring[-1] = ring[0]
    return ring


ANGLED = [(0.0, 0.0), (SIDE, 0.0), (SIDE, 4e5), (4e5, 4e5), (4e5, SIDE), (0.0, SIDE)]

ROOMS = {
    "square": [CORNERS],
    "hexagon": [circle(6, 5e5)],
    "angled": [ANGLED],
    "with a round hole": [CORNERS, circle(48, 2e5)],
    "sharp": [[(0.0, 0.0), (SIDE, 0.0), (0.0, 2e5)]],
}
OUTER_CORNERS = {"square": 4, "hexagon": 6, "angled": 5, "with a round hole": 4, "sharp": 3}


def asked_for(cells: int, **others: object) -> MeshRequest:
    """A request for so many cells in the plane."""
    return MeshRequest(cells=cells, plane=(SIDE, SIDE), periodic="none", **others)  # type: ignore[arg-type]
