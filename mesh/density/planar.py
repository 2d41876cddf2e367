"""Densities on planes: by name, from files, or functions of places (m, 3) in metres, with z = 0."""

import os
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.density.gridded import Shaping
from mesh.density.named import Density, uniform
from mesh.density.planar_grid import read_density_on_plane
from mesh.errors import MeshError
from mesh.mesh_request import MeshRequest

CIRCLE = "refined-circle"


@dataclass(frozen=True)
class RefinedDisc:
    """Equation (12) of Ju, Ringler and Gunzburger (2011) in a plane: cells are `ratio` times narrower within a circle.

    Widths change like a line over the `transition`; all lengths in metres.
    """

    x: float
    y: float
    radius: float
    transition: float
    ratio: float = 3.0

    def __call__(self, points: Array) -> Array:
        """Values (m,) at places (m, 3)."""
        distance = np.hypot(points[:, 0] - self.x, points[:, 1] - self.y) - self.radius
        share = np.clip(distance / self.transition, 0.0, 1.0)
        values: Array = ((1.0 - share) * self.ratio + share) ** 4
        return values


def named_on_plane(name: str, lengths: Array) -> Density | None:
    """The density of this name on a plane of these lengths (2,), metres, None if there is none.

    `refined-circle` is about the middle, a fifth of the shorter length in radius, with a transition half as wide.
    """
    if name == CIRCLE:
        radius = 0.2 * float(lengths.min())
        return RefinedDisc(0.5 * float(lengths[0]), 0.5 * float(lengths[1]), radius, 0.5 * radius)
    return uniform if name == "uniform" else None


def density_on_plane(request: MeshRequest, lengths: Array) -> Density:
    """The density that is asked for on a plane of these lengths (2,), found by its name or read from its file.

    Raises `MeshError` where there is none of that name, or if one that is not from a file should be shaped.
    """
    shaping = Shaping(request.density_floor, request.density_power, request.density_smoothing)
    given = request.density
    if isinstance(given, str | os.PathLike):
        name = os.fspath(given)
        if name.endswith(".nc"):
            return read_density_on_plane(name, request.density_variable, shaping)
        found = named_on_plane(name, lengths)
        if found is None:
            raise MeshError(
                f"there is no density named '{name}' on planes; choose uniform or {CIRCLE}, or a NetCDF file by its "
                "name in .nc"
            )
        given = found
    if (shaping, request.density_variable) != (Shaping(), MeshRequest.density_variable):
        raise MeshError("only densities from files are shaped; leave variable, floor, power and smoothing out")
    return given
