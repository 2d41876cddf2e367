"""Limited-memory quasi-Newton directions in Lloyd-scaled variables.

With w_i = 1/sqrt(2 x_i.M_i) the gradient is stored as w_i g_i and a displacement d_i as d_i / w_i. In these variables
Lloyd's step is minus the gradient, and the initial inverse Hessian is B = I, or that of `mesh.generation.multilevel`.

The two-loop recursion (Nocedal and Wright 2006, algorithm 7.4) runs on dot products alone. Kept are the steps s_k and
z_k = B y_k; the differences of gradients y_k need not be stored, as y_k.v is a difference of two dot products with
gradients. One pass over memory takes all dot products with the new gradient, another one forms the direction and the
next trial points. Vectors at different points are compared in space, not transported: steps are short against the
radius. Sums go by blocks of fixed size, so that results do not depend on the number of threads.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.integrals.moments import BLOCK

SMALLEST_CURVATURE = 1.0e-10
"""Pairs whose curvature s.y is below this part of y.By are not kept."""


@numba.njit(cache=True, fastmath={"reassoc", "contract", "nsz"})
def _block_dot(first: Array, second: Array, start: int, stop: int) -> float:
    """Dot product of two flat vectors over [start, stop)."""
    total = 0.0
    for index in range(start, stop):
        total += first[index] * second[index]
    return total


@numba.njit(parallel=True, cache=True)
def all_dots(
    gradient: Array, preconditioned: Array, steps: Array, changes: Array, slots: Index, partials: Array
) -> None:
    """Sums by block of g.s and g.z for the pairs in `slots`, and of g.Bg, to the columns of `partials`."""
    size = len(gradient)
    count = len(slots)
    for block in numba.prange(len(partials)):
        start, stop = 3 * BLOCK * block, min(3 * BLOCK * (block + 1), size)
        for k in range(count):
            partials[block, k] = _block_dot(gradient, steps[slots[k]], start, stop)
            partials[block, count + k] = _block_dot(gradient, changes[slots[k]], start, stop)
        partials[block, 2 * count] = _block_dot(gradient, preconditioned, start, stop)


@numba.njit(parallel=True, cache=True)
def new_pair(
    old_gradient: Array,
    old_preconditioned: Array,
    preconditioned: Array,
    step: Array,
    change: Array,
    length: float,
    partials: Array,
) -> None:
    """Finish a pair in place: step *= length, change = difference of B g.

    Columns of `partials` get g.step, g.change and step.step by block, g the old gradient.
    """
    size = len(step)
    for block in numba.prange(len(partials)):
        start, stop = 3 * BLOCK * block, min(3 * BLOCK * (block + 1), size)
        for index in range(start, stop):
            change[index] = preconditioned[index] - old_preconditioned[index]
        if length != 1.0:
            for index in range(start, stop):
                step[index] *= length
        partials[block, 0] = _block_dot(old_gradient, step, start, stop)
        partials[block, 1] = _block_dot(old_gradient, change, start, stop)
        partials[block, 2] = _block_dot(step, step, start, stop)


@numba.njit(cache=True)
def _move(points: Array, scale: float, direction: Array, length: float, cell: int, is_flat: bool, trial: Array) -> None:
    """Write points + length * scale * direction, back on the sphere, to `trial`; points without a step stay exact."""
    dx, dy, dz = direction[3 * cell], direction[3 * cell + 1], direction[3 * cell + 2]
    x = points[cell, 0] + length * scale * dx
    y = points[cell, 1] + length * scale * dy
    z = points[cell, 2] + length * scale * dz
    still = dx == 0.0 and dy == 0.0 and dz == 0.0
    factor = 1.0 if still or is_flat else 1.0 / np.sqrt(x * x + y * y + z * z)
    trial[cell, 0], trial[cell, 1], trial[cell, 2] = x * factor, y * factor, z * factor


@numba.njit(parallel=True, cache=True)
def combine_and_move(
    preconditioned: Array,
    steps: Array,
    changes: Array,
    slots: Index,
    scale: float,
    step_factors: Array,
    change_factors: Array,
    points: Array,
    scales: Array,
    length: float,
    slot: int,
    is_flat: bool,
    trial: Array,
    partials: Array,
) -> None:
    """Write -(scale B g + sum of factors times pairs), made tangential, to steps[slot], and move to `trial`.

    In the plane, `is_flat`, they are tangential anyway, z being zero.
    The first column of `partials` gets the largest squared displacement of a step of length one.
    """
    for block in numba.prange(len(partials)):
        first, last = BLOCK * block, min(BLOCK * (block + 1), len(points))
        direction = steps[slot]
        for index in range(3 * first, 3 * last):
            direction[index] = -scale * preconditioned[index]
        for k in range(len(slots)):
            step, change = steps[slots[k]], changes[slots[k]]
            step_factor, change_factor = step_factors[k], change_factors[k]
            for index in range(3 * first, 3 * last):
                direction[index] -= step_factor * step[index] + change_factor * change[index]
        largest = 0.0
        for cell in range(first, last):
            radial = 0.0
            if not is_flat:
                radial = (
                    direction[3 * cell] * points[cell, 0]
                    + direction[3 * cell + 1] * points[cell, 1]
                    + direction[3 * cell + 2] * points[cell, 2]
                )
            square = 0.0
            for axis in range(3):
                direction[3 * cell + axis] -= radial * points[cell, axis]
                square += direction[3 * cell + axis] ** 2
            largest = max(largest, square * scales[cell] ** 2)
            _move(points, scales[cell], direction, length, cell, is_flat, trial)
        partials[block, 0] = largest


@numba.njit(parallel=True, cache=True)
def move_all(points: Array, scales: Array, direction: Array, length: float, is_flat: bool, trial: Array) -> None:
    """Move points (n, 3) by `length` times the direction to `trial`."""
    for cell in numba.prange(len(points)):
        _move(points, scales[cell], direction, length, cell, is_flat, trial)


class PairMemory:
    """The last pairs (s_k, z_k = B y_k) and the dot products that the recursion needs.

    Tables run from the oldest pair to the newest; `slots` tells which row of `steps` and `changes` holds each. One
    more row than pairs is there for the step being tried.
    """

    def __init__(self, capacity: int, n_points: int) -> None:
        self.capacity = capacity
        self.steps = np.zeros((capacity + 1, 3 * n_points))
        self.changes = np.zeros((capacity + 1, 3 * n_points))
        self.clear()

    def clear(self) -> None:
        """Forget all pairs."""
        self.slots = np.zeros(0, np.int64)
        self.step_dots = np.zeros(0)
        self.change_dots = np.zeros(0)
        self._step_change = np.zeros((0, 0))
        self._change_change = np.zeros((0, 0))

    def spare_slot(self) -> int:
        """A row that no pair occupies."""
        return next(slot for slot in range(self.capacity + 1) if slot not in self.slots)

    def update(self, slot: int, old_dots: Array, new_dots: Array, least_curvature: float) -> None:
        """Record a new gradient, and keep the pair in `slot` if its curvature s.y is above the least.

        Both arrays hold the products of a gradient with all s, that of `slot` last, then with all z: `old_dots` of
        the gradient before the step, `new_dots` of the one after it.
        """
        steps, changes = np.split(new_dots, 2)
        step_column, change_column = np.split(new_dots - old_dots, 2)
        if step_column[-1] > max(SMALLEST_CURVATURE * change_column[-1], least_curvature) and change_column[-1] > 0.0:
            self._append(slot, step_column, change_column)
            kept = slice(len(steps) - len(self.slots), len(steps))
        else:
            kept = slice(0, len(steps) - 1)
        self.step_dots, self.change_dots = steps[kept], changes[kept]

    def _append(self, slot: int, step_column: Array, change_column: Array) -> None:
        """Add the newest pair; columns hold all s_i.y and z_i.y, its own last. Drops the oldest if there is no room."""
        first = max(0, len(self.slots) + 1 - self.capacity)
        self.slots = np.append(self.slots, slot)[first:]
        self._step_change = _bordered(self._step_change, step_column)[first:, first:]
        self._change_change = _bordered(self._change_change, change_column)[first:, first:]

    def factors(self) -> tuple[Array, Array, float]:
        """Coefficients of the product of the inverse Hessian H with the present gradient.

        H g = scale * B g + sum_i of step_factors[i] s_i + change_factors[i] z_i; the scale, sum of s_k.y_k over sum of
        y_k.B y_k, fits B to the pairs. Row i of the table of s.y with column j >= i holds older s, newer y.
        """
        count = len(self.slots)
        table = self._step_change
        scale = float(np.trace(table) / np.trace(self._change_change)) if count else 1.0
        alphas, step_factors = np.zeros(count), np.zeros(count)
        for i in range(count - 1, -1, -1):
            alphas[i] = (self.step_dots[i] - table[i, i + 1 :] @ alphas[i + 1 :]) / table[i, i]
        for i in range(count):
            preconditioned = scale * (self.change_dots[i] - self._change_change[i] @ alphas)
            step_factors[i] = alphas[i] - (preconditioned + table[:i, i] @ step_factors[:i]) / table[i, i]
        return step_factors, -scale * alphas, scale


def _bordered(table: Array, column: Array) -> Array:
    """Table (n, n) grown by `column` (n + 1,) as its last column and row."""
    return np.block([[table, column[:-1, None]], [column]])
