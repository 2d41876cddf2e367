"""Seas with their real coasts, from the distances to the coast of GSHHG on a grid of 0.1 degree."""

from functools import cache

import netCDF4
import numpy as np

from mesh.arrays import Array, Index
from mesh.geometry.angles import degrees_eastward
from mesh.geometry.sphere import to_lonlat
from mesh.regions.optional import package_for_coasts
from mesh.regions.outline import joined, straight_on_the_map
from mesh.regions.polygons import polygon_region
from mesh.regions.region import Region
from mesh.safe_files import dataset

EARTH_RADIUS = 6371.0
"""Kilometres, with which distances of the data become radians."""

ROW_SPACING = 0.1
"""Degrees between rows, the first at the south pole, and between columns, the first at 180 degrees west."""

CENTRAL_AMERICA = (
    *((-95, 16.8), (-92.5, 16.2), (-90, 15), (-87.5, 14), (-86, 12.8), (-84.8, 10.7), (-83.5, 9.5), (-82, 8.7)),
    *((-80.5, 8.6), (-79.6, 9.15), (-78.4, 9.15), (-77.5, 7.9), (-76, 6)),
)
SUEZ = ((31, 30.5), (35.5, 30.5))
"""Isthmuses, degrees east and north. In the data canals cut them; on a coarse mesh they are narrower than a cell."""

NORTH_ATLANTIC = (
    *((12, 65), (-66, 65), (-66, 62), (-64.9, 60.35), (-65, 59), (-66, 57), (-74, 52), (-85, 49), (-100, 50)),
    *((-102, 24), (-97.5, 18.5)),
    *CENTRAL_AMERICA,
    *((-70, 0), (12, 0), (12, 10), (0, 20), (-5, 33), (-5.6, 35.7), (-5.6, 36.2), (-4, 40), (0.5, 43), (2, 47)),
    *((6, 50), (9.5, 53.5), (9.4, 57.2), (8.5, 58.3), (12, 60)),
)
"""Corners, degrees east and north, of what holds the North Atlantic: through land, and across open water by walls.

Those are the equator, 65 degrees north, the mouths of Hudson Strait, the Mediterranean and the Baltic.
"""


def world_ocean() -> Region:
    """All that is connected with the sea, lakes left out; no water joins two seas at Panama or Suez."""
    lines = [straight_on_the_map(*np.radians(line).T) for line in (CENTRAL_AMERICA, SUEZ)]
    return Region("world-ocean", _distance_to_the_coast, isthmuses=joined(lines))


def north_atlantic() -> Region:
    """The Atlantic from the equator to 65 degrees north, with the Gulf of Mexico, the Caribbean and the North Sea."""
    bounds = polygon_region([[np.array([*NORTH_ATLANTIC, NORTH_ATLANTIC[0]], float)]], "north-atlantic")

    def distance(points: Array) -> Array:
        return np.minimum(_distance_to_the_coast(points), bounds.distance(points))

    return Region("north-atlantic", distance)


def _distance_to_the_coast(points: Array) -> Array:
    """Radians (n,) from unit vectors (n, 3) to the coast, positive at sea.

    Within Antarctica they are too small in size, as the data take the pole and the date line there for coasts.
    """
    values, unit = _table()
    longitude, latitude = to_lonlat(points)
    row, up = _places(np.degrees(latitude) + 90.0, len(values) - 1)
    column, across = _places(degrees_eastward(np.degrees(longitude) + 180.0), values.shape[1])
    east = (column + 1) % values.shape[1]
    below = (1.0 - across) * values[row, column] + across * values[row, east]
    above = (1.0 - across) * values[row + 1, column] + across * values[row + 1, east]
    return unit * ((1.0 - up) * below + up * above)


def _places(angle: Array, count: int) -> tuple[Index, Array]:
    """The last of `count` rows or columns before an angle, in degrees, and the share of the way to the next one."""
    place = angle / ROW_SPACING
    before = np.minimum(place.astype(np.intp), count - 1)
    return before, place - before


@cache
def _table() -> tuple[Array, float]:
    """Distances (1801, 3600), as the file packs them, and how many radians one of them is.

    The package reads a window for each call, and would have to be asked for a million of them; packed, the whole takes
    13 MB.
    """
    package = package_for_coasts("landmetrics", "a sea with its real coasts")
    with dataset(package.grid_path("distance_to_land", ROW_SPACING, 0.0, download=False)) as file:
        variable: netCDF4.Variable = file["distance_to_land"]
        scale = float(variable.scale_factor)
        variable.set_auto_maskandscale(False)
        return variable[:], scale / EARTH_RADIUS
