"""Terms that the loops over tiles do not know, added to what they compute.

Terms are evaluated in the order of the mesh, with any function that a user gives, and added in the order of the tiles.
A stage of a step is linear in the slope: so the loops over tiles take it with the slope of the bracket, and what the
terms add to that, times the weight of the stage, is added to its result.
"""

from collections.abc import Sequence

import numba
import numpy as np

from mesh.arrays import Array, Index
from swe.equations.kernels import add_scaled, compiled
from swe.equations.model import ShallowWaterModel
from swe.equations.terms import Term
from swe.state import State
from swe.tiles.cutting import Tiles


class AddedTerms:
    """Some `terms` of a model, beside its `tiles`; there may be none."""

    def __init__(self, model: ShallowWaterModel, terms: Sequence[Term], tiles: Tiles) -> None:
        self._model, self._terms = model, tuple(terms)
        self._orders = tiles.cell_order, tiles.edge_order
        self._own = tuple(slice(first[0], first[-1]) for first in (tiles.first_cell, tiles.first_edge))
        sizes = (model.mesh.n_cells, model.mesh.n_edges) if terms else (0, 0)
        self._state, self._rates = (tuple(np.zeros(size) for size in sizes) for _ in range(2))

    def __bool__(self) -> bool:
        return bool(self._terms)

    def evaluate(self, pair: tuple[Array, Array], time: float) -> None:
        """Find the rates of the terms for a pair of thickness and velocity in the order of the tiles."""
        at, rates = State(*map(_in_mesh_order, pair, self._orders, self._state)), State(*self._rates)
        rates.thickness.fill(0.0)
        rates.normal_velocity.fill(0.0)
        for term in self._terms:
            self._model.add_term(term, at, time, rates)

    def add(self, factor: float, pair: tuple[Array, Array]) -> None:
        """Add the rates that were found last, times a `factor` in seconds, to a pair in the order of the tiles.

        Entities that are in no tile keep what they have.
        """
        for values, rates, order, own in zip(pair, self._rates, self._orders, self._own, strict=True):
            if order is None:
                add_scaled(values[own], factor, rates[own], values[own])
            else:
                _add_scaled_from(values[own], factor, rates, order[own])


def _in_mesh_order(values: Array, order: Index | None, result: Array) -> Array:
    """`values` themselves where they are in the order of the mesh, or else `result` with them."""
    if order is None:
        return values
    _put(values, order, result)
    return result


@compiled
def _put(values: Array, order: Index, result: Array) -> None:
    """Put values in the order of the tiles to the places that they have in the mesh."""
    for i in numba.prange(order.size):
        result[order[i]] = values[i]


@compiled
def _add_scaled_from(values: Array, factor: float, rates: Array, order: Index) -> None:
    """Add `factor` times the rates, which are in the order of the mesh, to values in the order of the tiles."""
    for i in numba.prange(order.size):
        values[i] += factor * rates[order[i]]
