"""Terms added to the bracket of the scheme, each under a name of its own.

The tendency of a model is the bracket plus the sum of its terms. Most act in every stage of a step; a term may ask to
act after each step instead (`after_steps`). The diagnostics of a run show what each term does to the global integrals.
"""

from collections.abc import Callable
from typing import Self

import numpy as np

from mesh.arrays import Array
from mesh.shown import Rows, Shown, in_words
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.state import State

INTEGRALS = ("mass", "total_energy", "potential_enstrophy", "absolute_vorticity")
"""Global integrals whose budgets are kept."""

RESERVED = ("transport", "exchange", "coriolis", "gradient", "anticipation", "upwinding", "dissipation", "time")
"""Names that every budget uses."""

FieldFunction = Callable[[VoronoiMesh, State, float], Array]
"""A function of the mesh, in metres, the state, and the time since the start, s."""


class Term:
    """A term of the equations.

    Attributes
    ----------
    name
        Part of the names of the diagnostics, such as `total_energy_rate_wind`.
    meaning
        What changes the integrals, as the end of a sentence: "by the wind".
    changes
        Those of `INTEGRALS` that the term changes; their rates are diagnosed.
    after_steps
        Whether the term acts after each step (`apply`) rather than in its stages.
    rings
        How many rings of cells must stand round those of a process for the term to be right at these; by default as
        many as the bracket needs.
    """

    name: str
    meaning: str
    changes: tuple[str, ...]
    after_steps = False
    rings = 2

    def at_walls(self, wall_slip: float) -> Self:
        """The term in a model with `wall_slip`, from 0 (no slip) to 1 (free slip); by default the same for all."""
        return self

    def change_vorticity(self, state: State, potential_vorticity: Array, at_edges: Array) -> None:
        """Change the potential vorticity at edges (n_edges,) that the Coriolis flux carries, in place.

        `potential_vorticity` is that of `state` at vertices. Does nothing by default.
        """

    def add(self, mesh: VoronoiMesh, state: State, time: float, tendency: State) -> None:
        """Add the term at `state` and `time`, seconds since the start, to `tendency`; does nothing by default."""

    def add_source(self, mesh: VoronoiMesh, state: State, time: float, tendency: Array) -> None:
        """Add the part in dh/dt (n_cells,) alone; by default what `add` adds there, found by evaluating all of it."""
        self.add(mesh, state, time, State(tendency, np.zeros(mesh.n_edges)))

    def add_acceleration(self, mesh: VoronoiMesh, state: State, time: float, tendency: Array) -> None:
        """Add the part in du/dt (n_edges,) alone; by default what `add` adds there, found by evaluating all of it."""
        self.add(mesh, state, time, State(np.zeros(mesh.n_cells), tendency))

    def apply(self, state: State, time_step: float) -> None:
        """Change `state` by the effect over `time_step` seconds of a term that acts after steps."""
        raise NotImplementedError(f"the term {self.name} acts in the stages of a step")


class Forcing(Shown, Term):
    """A user's own term, made of plain functions of mesh, state and time, which must not change their arguments.

    Parameters
    ----------
    name
        Its name in the diagnostics: letters, digits and underscores.
    acceleration
        Returns what is added to du/dt at edges (n_edges,), m/s2, positive from `cells_on_edge[e, 0]` to `[e, 1]`;
        `mesh.discrete.operators.normal_component` projects vectors.
    source
        Returns what is added to dh/dt at cells (n_cells,), m/s.

    Raises
    ------
    InputError
        If the name cannot be used or there is no function; later, when the model is made or during a run, if a function
        fails or does not return one number for each edge or cell.
    """

    def __init__(
        self, name: str, acceleration: FieldFunction | None = None, source: FieldFunction | None = None
    ) -> None:
        if not (isinstance(name, str) and name.isidentifier() and name.isascii()):
            raise InputError(f"the name of a term is {name!r}; it must be made of letters, digits and underscores")
        if name in RESERVED:
            raise InputError(f"a term cannot be named '{name}', which every budget uses already; choose another name")
        if not (callable(acceleration) or callable(source)):
            raise InputError(f"the term {name} does nothing; give it a function, acceleration= or source=")
        self.name = name
        self.meaning = f"by {name.replace('_', ' ')}"
        self.acceleration, self.source = acceleration, source
        of_source, of_acceleration = set(INTEGRALS) - {"absolute_vorticity"}, set(INTEGRALS) - {"mass"}
        changed = (of_source if source else set()) | (of_acceleration if acceleration else set())
        self.changes = tuple(integral for integral in INTEGRALS if integral in changed)

    def _title_and_rows(self) -> tuple[str, Rows]:
        """Its name and what it changes, and the functions and coefficients that it was made with."""
        rows = {"changes": ", ".join(self.changes).replace("_", " ")}
        for name, value in vars(self).items():
            if not name.startswith("_") and name not in ("name", "meaning", "changes") and value is not None:
                own = getattr(value, "__self__", None) is self
                rows |= {} if own else {name.replace("_", " "): in_words(value)}
        return f"{type(self).__name__} {self.name}", rows

    def stable_step(self, mesh: VoronoiMesh) -> float:
        """Longest time step, s, that the term itself stands on `mesh`, in metres; without bound by default."""
        return float("inf")

    def add(self, mesh: VoronoiMesh, state: State, time: float, tendency: State) -> None:
        """See `Term`."""
        self.add_acceleration(mesh, state, time, tendency.normal_velocity)
        self.add_source(mesh, state, time, tendency.thickness)

    def add_source(self, mesh: VoronoiMesh, state: State, time: float, tendency: Array) -> None:
        """See `Term`."""
        if self.source is not None:
            tendency[:] += self._values("source", mesh, state, time, mesh.n_cells)

    def add_acceleration(self, mesh: VoronoiMesh, state: State, time: float, tendency: Array) -> None:
        """See `Term`."""
        if self.acceleration is not None:
            tendency[:] += self._values("acceleration", mesh, state, time, mesh.n_edges)

    def _values(self, what: str, mesh: VoronoiMesh, state: State, time: float, size: int) -> Array:
        """The values of a user's function: one number for all entities, or one for each of `size`."""
        try:
            values = np.asarray(getattr(self, what)(mesh, state, time), dtype=np.float64)
        except InputError:
            raise
        except (Exception, SystemExit) as error:
            raise InputError(f"the {what} of the term {self.name} failed at {time:g} s: {error!r}") from error
        if values.shape not in ((), (size,)):
            raise InputError(
                f"the {what} of the term {self.name} has shape {values.shape}; the mesh needs ({size},), or one number"
            )
        return values
