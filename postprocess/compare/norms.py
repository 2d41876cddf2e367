"""Error norms of Williamson et al. (1992), section 2.4, equations (82) to (84), and those that follow for vectors."""

import math
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array


@dataclass(frozen=True)
class Norms:
    """Norms of an error relative to those of the reference, without units; nan where the reference is zero."""

    l1: float
    l2: float
    linf: float


def scalar_norms(values: Array, reference: Array, area: Array) -> Norms:
    """Norms of `values - reference`, both (n,), under the areas (n,) of the cells or triangles that they stand for.

    The area of each counts once, so that a norm does not depend on where a mesh is fine.
    """
    return _norms(np.abs(values - reference), np.abs(reference), area)


def vector_norms(values: tuple[Array, Array], reference: tuple[Array, Array], area: Array) -> Norms:
    """Norms of the difference of two vector fields, given as zonal and meridional components (n,).

    The length sqrt(du^2 + dv^2) of the difference takes the place of the absolute value of a scalar: the components
    are not measured one by one, and the result does not depend on where the poles are.
    """
    error = np.hypot(values[0] - reference[0], values[1] - reference[1])
    return _norms(error, np.hypot(*reference), area)


def _norms(error: Array, size: Array, area: Array) -> Norms:
    """Norms of an error of which only the size matters, relative to the `size` of the reference."""
    return Norms(
        l1=_ratio(np.sum(area * error), np.sum(area * size)),
        l2=math.sqrt(_ratio(np.sum(area * error**2), np.sum(area * size**2))),
        linf=_ratio(error.max(), size.max()),
    )


def _ratio(error: float, size: float) -> float:
    return float(error / size) if size > 0.0 else math.nan
