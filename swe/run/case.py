"""What a simulation requires of a test case, and the fields that it gets from it, checked."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from mesh.arrays import Array
from mesh.discrete.walls import closed_mesh, wall_edges
from mesh.integrals.quadrature import Sampling
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.model import check_field
from swe.equations.soundness import has_negative_kites, problem_at_vertices, problem_with_state
from swe.equations.terms import Forcing
from swe.errors import InputError
from swe.parallel.processes import ONE_PROCESS, Processes, anywhere
from swe.state import State


class Case(Protocol):
    """What a simulation requires of a test case: see `cases.base.Case`.

    A case may also have a function `terms()`, which returns the terms that it adds to the equations.
    """

    @property
    def name(self) -> str:
        """Name by which the case is run."""

    @property
    def radius(self) -> float:
        """Radius of the sphere, m."""

    @property
    def gravity(self) -> float:
        """Acceleration of gravity, m/s2."""

    @property
    def prescribed_wind(self) -> bool:
        """Whether the wind stays as it was at the start, so that only thickness evolves."""

    def initial_state(self, mesh: VoronoiMesh, sampling: Sampling) -> State:
        """State at time zero; thickness at cell centres, or its mean over each cell."""

    def topography_on(self, mesh: VoronoiMesh, sampling: Sampling) -> Array:
        """Height of the bottom at cell centres, or its mean over each cell, m."""

    def coriolis_on(self, mesh: VoronoiMesh) -> Array:
        """Coriolis parameter at vertices, 1/s."""

    def parameters(self) -> dict[str, float]:
        """Parameters of the case by name, for the record of the run."""


@dataclass(frozen=True, eq=False)
class CaseFields:
    """A case on a mesh in metres: the fields that the equations need, the initial state, and terms added by the case.

    `kites_matter` is true if thickness at vertices is used and may lie outside the range of their cells.
    """

    case: Case
    mesh: VoronoiMesh
    topography: Array
    coriolis: Array
    state: State
    forcings: tuple[Forcing, ...]
    kites_matter: bool


def case_fields(case: Case, mesh: VoronoiMesh, sampling: Sampling, processes: Processes = ONE_PROCESS) -> CaseFields:
    """The fields of `case` on `mesh`, scaled to its radius; raises `InputError` if they are invalid.

    All `processes` do this together, each on its part of the mesh. The fields of a case must follow from the place
    alone, so that two processes find the same where both have it.
    """
    mesh = mesh.scaled(case.radius)
    negative = anywhere(processes, int(has_negative_kites(mesh))) > 0
    kites_matter = negative and not case.prescribed_wind
    fields = processes.together(lambda: _fields(case, mesh, sampling, kites_matter, processes))
    if not processes.alone:
        _require_same_everywhere(fields, processes)
    return fields


def _fields(case: Case, mesh: VoronoiMesh, sampling: Sampling, kites_matter: bool, processes: Processes) -> CaseFields:
    topography = _asked(case, case.topography_on, mesh, sampling)
    coriolis = _asked(case, case.coriolis_on, mesh)
    check_field("topography", topography, mesh.n_cells)
    check_field("coriolis", coriolis, mesh.n_vertices)
    state = initial_state(case, mesh, sampling, kites_matter, processes)
    return CaseFields(case, mesh, topography, coriolis, state, _forcings(case), kites_matter)


def initial_state(
    case: Case, mesh: VoronoiMesh, sampling: Sampling, kites_matter: bool, processes: Processes = ONE_PROCESS
) -> State:
    """The state at time zero, at rest at walls; raises `InputError` if it is invalid.

    Every one of the `processes` looks at its own part.
    """
    state = _asked(case, case.initial_state, mesh, sampling)
    if not isinstance(state, State):
        raise InputError(f"initial_state of {case.name} gives {type(state).__name__}; it must give a State")
    check_field("initial thickness", state.thickness, mesh.n_cells)
    check_field("initial normal velocity", state.normal_velocity, mesh.n_edges)
    problem = problem_with_state(mesh, state, processes)
    if problem:
        raise InputError(f"the initial {problem}; correct the parameters of {case.name}")
    problem = problem_at_vertices(closed_mesh(mesh), state.thickness, processes) if kites_matter else None
    if problem:
        raise InputError(f"the initial {problem}")
    state.normal_velocity[wall_edges(mesh)] = 0.0
    return state


def _require_same_everywhere(fields: CaseFields, processes: Processes) -> None:
    """Raise `InputError` if thickness, velocity or topography differ between two processes at the same place."""
    here = fields.state
    there, bottom = here.copy(), State(fields.topography.copy(), np.zeros_like(here.normal_velocity))
    processes.exchange(there)
    processes.exchange(bottom)
    pairs = {
        "initial thickness": (here.thickness, there.thickness),
        "initial normal velocity": (here.normal_velocity, there.normal_velocity),
        "topography": (fields.topography, bottom.thickness),
    }

    def require_same() -> None:
        for name, (mine, owners) in pairs.items():
            if not np.array_equal(mine, owners):
                raise InputError(
                    f"the {name} of {fields.case.name} depends on the part of the mesh that it is asked for; let it "
                    "follow from the place alone, or run on one process"
                )

    processes.together(require_same)


def _forcings(case: Case) -> tuple[Forcing, ...]:
    """The terms added by the case; none if it has no `terms`."""
    terms = getattr(case, "terms", None)
    if terms is None:
        return ()
    given = _asked(case, terms)
    if not (isinstance(given, tuple | list) and all(isinstance(term, Forcing) for term in given)):
        raise InputError(f"terms of {case.name} gives {given!r:.80}; it must give a tuple of swe.Forcing")
    return tuple(given)


def _asked(case: Case, function: Callable[..., Any], *arguments: object) -> Any:
    """The result of a `function` of the case, which may be the user's own and fail in any way."""
    try:
        return function(*arguments)
    except (InputError, MemoryError):
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{function.__name__} of {case.name} failed: {error!r}") from error


def require_finite_integrals(integrals: dict[str, float], case_name: str) -> None:
    """Raise `InputError` if a global integral is not finite, so that its changes cannot be computed."""
    for name, value in integrals.items():
        if not np.isfinite(value):
            raise InputError(
                f"the initial {name.replace('_', ' ')} is {value:g}, beyond the range of numbers; correct the "
                f"parameters of {case_name}"
            )
