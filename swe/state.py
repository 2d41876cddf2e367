"""The prognostic fields of the shallow-water equations, and their tendencies."""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.shown import Rows, Shown, span


@dataclass(frozen=True, eq=False, repr=False)
class State(Shown):
    """`thickness` at cells (n_cells,), m, and `normal_velocity` at edges (n_edges,), m/s.

    The normal velocity is positive from `cells_on_edge[e, 0]` to `[e, 1]`. A tendency takes the same form, in
    units per second.
    """

    thickness: Array
    normal_velocity: Array

    def _title_and_rows(self) -> tuple[str, Rows]:
        h, u = self.thickness, self.normal_velocity
        return f"State of {h.size} cells and {u.size} edges", {
            "thickness": span(h, "m"),
            "normal velocity": span(u, "m/s"),
        }

    def copy(self) -> "State":
        """An independent copy."""
        return State(self.thickness.copy(), self.normal_velocity.copy())

    def empty_like(self) -> "State":
        """Uninitialised arrays of the same shapes."""
        return State(np.empty_like(self.thickness), np.empty_like(self.normal_velocity))
