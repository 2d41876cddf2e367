"""The region that a user names: a box, a polygon, a field in a file, or a sea with its real coast."""

from collections.abc import Callable
from pathlib import Path

from mesh.errors import MeshError
from mesh.regions.box import BOX, box_region
from mesh.regions.gridded import read_gridded
from mesh.regions.polygons import read_polygons
from mesh.regions.real_ocean import north_atlantic, world_ocean
from mesh.regions.region import Region

NAMED: dict[str, Callable[[], Region]] = {"north-atlantic": north_atlantic, "world-ocean": world_ocean}
"""Seas with their real coasts."""

GEOJSON = (".geojson", ".json")


def find_region(text: str) -> Region:
    """The region that `text` names.

    That is a box in degrees, `WEST,EAST,SOUTH,NORTH`; a file of polygons, `FILE.geojson`; a mask or a signed distance
    in a file, `FILE.nc:VARIABLE`; or one of `NAMED`. Raises `MeshError` where it is none of these, or cannot be used.
    """
    if text in NAMED:
        return NAMED[text]()
    if BOX.fullmatch(text):
        return box_region(text)
    if text.endswith(GEOJSON):
        return read_polygons(Path(text))
    path, _, variable = text.rpartition(":")
    if path and variable:
        return read_gridded(Path(path), variable)
    raise MeshError(
        f"there is no region named '{text}'; choose one of {', '.join(NAMED)}, a box in degrees WEST,EAST,SOUTH,NORTH, "
        "a file of polygons FILE.geojson, or a mask or signed distance FILE.nc:VARIABLE"
    )
