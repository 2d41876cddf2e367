"""A box in longitude and latitude, such as `280,350,10,60`."""

import re

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.errors import MeshError
from mesh.geometry.angles import degrees_eastward
from mesh.geometry.sphere import to_lonlat
from mesh.regions.outline import joined, signed, straight_on_the_map
from mesh.regions.region import Region

NUMBER = r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*"
BOX = re.compile(",".join([NUMBER] * 4))
"""Four numbers with commas between them."""

ORDER = "write WEST,EAST,SOUTH,NORTH in degrees, such as 280,350,10,60"

ROUNDING = 1e-9
"""Degrees: points so little outside of the box are inside, as those on its edges are."""


def box_region(text: str) -> Region:
    """The region between two meridians and two parallels, its edges included; it runs eastward from the first.

    Raises `MeshError` where that is no box.
    """
    west, east, south, north = (float(number) for number in text.split(","))
    _require_box(west, east, south, north, text)
    width = 360.0 if east - west == 360.0 else float(degrees_eastward(np.array(east - west)))

    def inside(points: Array) -> NDArray[np.bool_]:
        longitude, latitude = (np.degrees(angle) for angle in to_lonlat(points))
        eastward = degrees_eastward(longitude - west + ROUNDING)
        return (eastward <= width + 2.0 * ROUNDING) & (np.abs(latitude - 0.5 * (south + north)) <= half + ROUNDING)

    half = 0.5 * (north - south)
    edges = [([west, west + width], [side, side]) for side in (south, north) if abs(side) < 90.0]
    if width < 360.0:
        edges += [([side, side], [south, north]) for side in (west, west + width)]
    outline = joined([straight_on_the_map(np.radians(lon), np.radians(lat)) for lon, lat in edges])
    return Region(text, lambda points: signed(outline.distance(points), inside(points)), inside)


def _require_box(west: float, east: float, south: float, north: float, text: str) -> None:
    if not (-90.0 <= south <= 90.0 and -90.0 <= north <= 90.0):
        raise MeshError(f"the box {text} has latitudes beyond the poles; {ORDER}")
    if south >= north:
        raise MeshError(
            f"the box {text} is upside down: its south, {south:g}, is not below its north, {north:g}; {ORDER}"
        )
    if not (abs(west) <= 360.0 and abs(east) <= 720.0 and abs(east - west) <= 360.0):
        raise MeshError(f"the box {text} has longitudes that go round more than once; {ORDER}")
    if degrees_eastward(np.array(east - west)) == 0.0 and east - west != 360.0:
        raise MeshError(f"the box {text} has no width; {ORDER}, and -180,180 for all longitudes")
