"""Where the points of a page are: longitudes and latitudes on the sphere, x and y on a plane, in whole steps.

`web/src/sphere.js` and `web/src/plane.js` are the way back.
"""

from typing import Any

import numpy as np

from mesh.arrays import Array
from mesh.geometry.angles import TURN, eastward
from mesh.geometry.surface import surface_of
from mesh.voronoi_mesh import Place, VoronoiMesh
from postprocess.view.packing import packed_list

ANGLE_BITS = 24
"""Of longitudes and latitudes: steps of two metres on the Earth."""

LENGTH_BITS = 24
"""Of x and y: steps of six centimetres on a plane of a thousand kilometres."""


def packed_places(mesh: VoronoiMesh, with_edges: bool) -> dict[str, Any]:
    """Places of all vertices, cells and, where asked for, edges, and the `spacing`, as the page reads them.

    The spacing is the shortest distance between neighbouring cells, in radii of the sphere or in lengths of the longer
    side of the plane.
    """
    names: tuple[Place, ...] = ("vertex", "cell", "edge") if with_edges else ("vertex", "cell")
    first, second = (np.concatenate(each) for each in zip(*(mesh.coordinates(name) for name in names), strict=True))
    packed = _on_the_sphere(first, second) if mesh.on_a_sphere else _on_the_plane(mesh, first, second)
    unit = mesh.sphere_radius if mesh.on_a_sphere else max(packed["plane"]["extent"])
    return {"points": len(first), **packed, "spacing": float(mesh.dc_edge.min() / unit)}


def _on_the_sphere(longitude: Array, latitude: Array) -> dict[str, Any]:
    top = 2**ANGLE_BITS - 1
    return {
        "angleBits": ANGLE_BITS,
        "longitude": packed_list(np.rint(eastward(longitude) / TURN * top).astype(np.int64), ANGLE_BITS),
        "latitude": packed_list(np.rint((latitude / np.pi + 0.5) * top).astype(np.int64), ANGLE_BITS),
    }


def _on_the_plane(mesh: VoronoiMesh, x: Array, y: Array) -> dict[str, Any]:
    """Steps of the same length along x and y, and what is shown of the plane, in metres."""
    top = 2**LENGTH_BITS - 1
    low = [float(each.min()) for each in (x, y)]
    span = max(float(np.ptp(each)) for each in (x, y))
    periods = surface_of(mesh).periods
    shown = [
        _shown(values, cells, float(period))
        for values, cells, period in zip((x, y), mesh.coordinates("cell"), periods, strict=True)
    ]
    steps = [np.rint((each - lowest) / span * top).astype(np.int64) for each, lowest in zip((x, y), low, strict=True)]
    return {
        "lengthBits": LENGTH_BITS,
        "x": packed_list(steps[0], LENGTH_BITS),
        "y": packed_list(steps[1], LENGTH_BITS),
        "plane": {
            "low": low,
            "span": span,
            "begin": [begin for begin, _ in shown],
            "extent": [extent for _, extent in shown],
            "periods": periods.tolist(),
        },
    }


def _shown(values: Array, cells: Array, period: float) -> tuple[float, float]:
    """Where the plane begins along an axis and how long it is there: a period that holds all cells, or all points."""
    if period == 0.0:
        return float(values.min()), float(np.ptp(values))
    return (0.0 if ((cells >= 0.0) & (cells < period)).all() else float(cells.min())), period
