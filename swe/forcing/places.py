"""What the ready terms share: fields given by place, things made once for a mesh, bounds of coefficients."""

import math
from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np

from mesh.arrays import Array
from mesh.plain import plain_number
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError

Made = TypeVar("Made")

PlaceFunction = Callable[[Array, Array], Array | float]
"""A function of longitude and latitude, radians, that returns one value per position, or one number for all; on a plane
of x and y, metres."""

Field = float | PlaceFunction
"""The same number everywhere, or a function of the place."""


class OncePerMesh(Generic[Made]):
    """What `make` makes of a mesh, made again only when another mesh comes."""

    def __init__(self, make: Callable[[VoronoiMesh], Made]) -> None:
        self._make = make
        self._last: tuple[VoronoiMesh, Made] | None = None

    def __call__(self, mesh: VoronoiMesh) -> Made:
        """What has been made of `mesh`."""
        last = self._last
        if last is None or last[0] is not mesh:
            last = self._last = mesh, self._make(mesh)
        return last[1]


def sampled(field: Field, longitude: Array, latitude: Array) -> Array:
    """Values (n,) of a field at places (n,); raises `ValueError` where it gives neither n numbers nor one."""
    values = field(longitude, latitude) if callable(field) else field
    return np.array(np.broadcast_to(np.asarray(values, dtype=np.float64), longitude.shape))


def require_field(what: str, field: Field) -> None:
    """Raise `InputError` unless a field is a function or a finite number."""
    if not callable(field) and not math.isfinite(plain_number(what, field, InputError)):
        raise InputError(
            f"{what} is {field}; give a finite number, or a function of longitude and latitude, on a plane of x and y"
        )


def coefficient(what: str, value: float, positive: bool = False) -> float:
    """`value` as a number; raises `InputError` unless it is finite and not negative, or `positive`."""
    number = plain_number(what, value, InputError)
    if not (math.isfinite(number) and (number > 0.0 if positive else number >= 0.0)):
        raise InputError(f"{what} is {number:g}; it must be {'positive' if positive else 'zero or positive'}")
    return number
