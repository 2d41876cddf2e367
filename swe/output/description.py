"""Descriptions of a run: what it is made of, and where it stands."""

import hashlib
from collections.abc import Iterable
from dataclasses import asdict, dataclass

import numpy as np

from mesh.arrays import Array
from mesh.files.whole_mesh import WholeMesh
from mesh.plain import recorded
from swe.configuration import Configuration
from swe.diagnostics.invariants import Invariants
from swe.diagnostics.outputs import FIELDS
from swe.equations.model import ShallowWaterModel
from swe.equations.terms import Term
from swe.errors import InputError
from swe.parallel.processes import Place, Processes
from swe.state import State
from swe.stepping.time_stepping import Tendency

ABSENT: dict[str, object] = {"fields": list(FIELDS), "forcings": []}
"""What holds for runs of earlier versions, whose records do not say."""

ABSENT_CONFIGURATION = {"scheme": "ringler2010", "upwinding": 0.0, "wall_slip": 0.0}
"""The same for their configuration."""


@dataclass(frozen=True, eq=False)
class RunDescription:
    """What is written about a run and does not change as it proceeds, and what its diagnostics are made with.

    `start_hash` is the result of the function of that name before the first step, as states change in place. `fields`
    are the names of the fields in snapshots, `forcings` those of the terms added by the case, and `loops` says which
    loops take the steps, "fused" or "plain".
    """

    case_name: str
    parameters: dict[str, float]
    configuration: Configuration
    model: ShallowWaterModel
    start_hash: str
    initial_invariants: Invariants
    fields: tuple[str, ...]
    forcings: tuple[str, ...]
    loops: str

    @property
    def processes(self) -> Processes:
        """Those that share the run."""
        return self.model.processes

    @property
    def mesh(self) -> WholeMesh:
        """The mesh of all processes, scaled to the radius of the case."""
        return self.processes.whole_mesh(self.model.mesh)


@dataclass(frozen=True, eq=False)
class Moment:
    """Where a run stands: seconds since its start, steps taken, state, Courant number, and the tendency function."""

    time: float
    steps: int
    state: State
    courant_number: float
    tendency: Tendency


def described(run: RunDescription) -> dict[str, object]:
    """What a run must have in common with the one that it resumes, as the record stores it."""
    try:
        as_recorded = recorded(run.parameters)
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(
            f"the parameters of {run.case_name} cannot be recorded ({error}); give numbers, words, or lists of them"
        ) from error
    return {
        "mesh_hash": run.processes.on_first(run.mesh.identity),
        "case": run.case_name,
        "parameters": as_recorded,
        "configuration": asdict(run.configuration),
        "start_hash": run.start_hash,
        "fields": list(run.fields),
        "forcings": list(run.forcings),
    }


def start_hash(model: ShallowWaterModel, state: State, forcings: Iterable[Term] = ()) -> str:
    """SHA-256, in hexadecimal, of gravity, `state`, topography, Coriolis parameter and tendencies of the `forcings`."""
    digest, processes = hashlib.sha256(np.float64(model.gravity).tobytes()), model.processes
    fields = [*_in_places(state), ("cells", model.topography), ("vertices", model.coriolis)]
    for term in forcings:
        fields += _in_places(model.tendency_of(term, state))
    for place, values in fields:
        digest.update(np.ascontiguousarray(processes.gathered(place, values)).data)
    return processes.on_first(digest.hexdigest)


def _in_places(state: State) -> list[tuple[Place, Array]]:
    return [("cells", state.thickness), ("edges", state.normal_velocity)]


def difference(name: str, then: object, now: object) -> str:
    """How the run in a directory differs from the one asked for, as part of a sentence."""
    if isinstance(then, dict) and isinstance(now, dict):
        for key in (*now, *then):
            if then.get(key) != now.get(key):
                return difference(key, then.get(key), now.get(key))
    if name == "mesh_hash":
        return "a run on another mesh"
    if name == "start_hash":
        return "a run of a case with another start, topography, rotation or forcing"
    return f"a run with {name.replace('_', ' ')} = {_shown(then)}, not {_shown(now)}"


def _shown(value: object) -> str:
    return f"{value:.15g}" if isinstance(value, float | int) else str(value)
