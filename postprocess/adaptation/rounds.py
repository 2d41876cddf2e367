"""Rounds of running a case and making a mesh for what the run shows."""

import json
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mesh.coast.generation import coast_smoothing, region_mesh
from mesh.errors import MeshWarning
from mesh.files.io import read_mesh, write_mesh
from mesh.generation.pipeline import generate_mesh
from mesh.mesh_request import MeshRequest
from mesh.plain import recorded
from mesh.regions.find import find_region
from mesh.safe_files import written_aside
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.adaptation.carried import Continued, carried_over
from postprocess.adaptation.energy_density import MILD_FLOOR, MILD_POWER, request_for, write_energy
from postprocess.runs.reading import Run
from postprocess.studies.study_folder import Task, Tell, require_days
from swe.configuration import Options, SchemeName
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError, RunError
from swe.run.case import Case
from swe.state import State

PLAN_FILE = "plan.json"
MOST_ROUNDS = 100
SNAPSHOTS = 20
"""Snapshots of a round, half of which go into its means."""

DIAGNOSTICS_PER_SNAPSHOT = 10
"""Rows of diagnostics between snapshots that lie days apart. The default step divides the interval of these rows."""

MESH_TOLERANCE = 1e-4
"""Residual, in mean spacings, at which an adapted mesh is taken: the field that it follows is known less well."""


@dataclass(frozen=True)
class Plan:
    """`case` run for `days` on a uniform mesh of `cells` cells, then on each of `rounds` meshes that follow it.

    Each round goes on from the state that the one before has reached, or, with `begin_again`, from the start of the
    case. A uniform mesh of `fine` cells, run for as long, is what all are measured against. Meshes cover the sphere, or
    with a `coast` (`mesh.regions.find`) the sea within it, the same for all. Densities are
    max(density_floor, x)^density_power, x being the kinetic energy over its largest value. Everything is in `folder`.
    """

    folder: Path
    case: Case
    cells: int
    fine: int
    days: float
    rounds: int
    begin_again: bool = False
    coast: str | None = None
    scheme: SchemeName = Options.scheme
    density_floor: float = MILD_FLOOR
    density_power: float = MILD_POWER

    def __post_init__(self) -> None:
        require_days(self.days)
        if self.case.radius == 0.0:
            raise InputError(f"{self.case.name} is on a plane; meshes are adapted on a sphere alone")
        if not 1 <= self.rounds <= MOST_ROUNDS:
            raise InputError(f"a mesh cannot be adapted {self.rounds} times; ask for 1 to {MOST_ROUNDS} rounds")
        if not self.fine > self.cells:
            raise InputError(
                f"the fine mesh of {self.fine} cells is to be finer than one of {self.cells}; ask for more cells"
            )

        if not (0.0 < self.density_floor <= 1.0 and 0.0 < self.density_power < float("inf")):
            raise InputError(
                f"a density cannot have the floor {self.density_floor:g} and the power {self.density_power:g}; give a "
                "floor above 0 and up to 1, and a power above 0"
            )

    @property
    def snapshot_days(self) -> float:
        """Days between snapshots."""
        return self.days / SNAPSHOTS

    @property
    def diagnostics_interval(self) -> float:
        """Seconds between rows of diagnostics: the usual, or more in long rounds, so that steps are not cut."""
        return max(Options.diagnostics_interval, self.snapshot_days * SECONDS_PER_DAY / DIAGNOSTICS_PER_SNAPSHOT)

    def recorded(self) -> dict[str, Any]:
        """What is asked for, as numbers and words."""
        asked = {name: value for name, value in vars(self).items() if name not in ("folder", "case")}
        return {"case": self.case.name, "parameters": recorded(self.case.parameters()), **asked}

    def days_of_whole(self) -> float:
        """Days that the fine run and the uniform one of as many cells take together with all rounds."""
        return self.days if self.begin_again else self.days * (self.rounds + 1)


@dataclass(frozen=True)
class Round:
    """One round: its number, 0 on the uniform mesh, the day of the case on which it began, and its run."""

    number: int
    first_day: float
    run: Run


@dataclass(frozen=True)
class Adaptation:
    """The rounds, and uniform meshes: of as many cells, of the cost of the last round, and the fine one."""

    rounds: tuple[Round, ...]
    uniform: Run
    equal_cost: Run
    fine: Run


def adapt(plan: Plan, progress: bool, tell: Tell) -> Adaptation:
    """Carry out a plan; what the folder holds already is taken from there, and a run that was broken off goes on.

    Raises `InputError` or `MeshError` where a mesh or a run cannot be made, `RunError` where a run fails.
    """
    _require_same_plan(plan)
    runner = _Runner(plan, progress, tell)
    rounds = [Round(0, 0.0, runner.uniform("round-0", plan.cells, plan.days))]
    while len(rounds) <= plan.rounds:
        rounds.append(runner.following(rounds[-1]))
    whole = plan.days_of_whole()
    uniform = rounds[0].run if plan.begin_again else runner.uniform("uniform", plan.cells, whole)
    same = cells_of_equal_cost(uniform, rounds[-1].run)
    equal_cost = runner.uniform("equal-cost", same, whole)
    return Adaptation(tuple(rounds), uniform, equal_cost, runner.uniform("fine", plan.fine, whole))


def cost_per_day(run: Run) -> float:
    """Cells times steps that a run takes for a day: its cost, whatever the machine."""
    return run.steps * run.cells / float(run.days[-1])


def cells_of_equal_cost(uniform: Run, adapted: Run) -> int:
    """Cells of a uniform mesh that costs as much per day as the `adapted` one.

    The cost of a uniform mesh of N cells goes like N^(3/2), as its steps go like its spacings.
    """
    return round(uniform.cells * (cost_per_day(adapted) / cost_per_day(uniform)) ** (2.0 / 3.0))


def _require_same_plan(plan: Plan) -> None:
    """Keep what the plan asks for beside its runs; raise `InputError` if the folder was begun with another plan."""
    plan.folder.mkdir(parents=True, exist_ok=True)
    path = plan.folder / PLAN_FILE
    content = json.dumps(plan.recorded(), indent=2) + "\n"
    try:
        before = path.read_text()
    except FileNotFoundError:
        with written_aside(path) as aside:
            aside.write_text(content)
        return
    if before != content:
        raise InputError(f"{path} tells of another case, mesh or length; choose another folder, or remove this one")


class _Runner:
    """Makes meshes and runs of a plan, or finds them."""

    def __init__(self, plan: Plan, progress: bool, tell: Tell) -> None:
        self._plan, self._progress, self._tell = plan, progress, tell
        self._region = None if plan.coast is None else find_region(plan.coast)
        # Finer meshes fill the same sea: straits that only they resolve would be differences of the case.
        self._smoothing = None if self._region is None else coast_smoothing(self._region, plan.cells)

    def uniform(self, name: str, cells: int, days: float) -> Run:
        """The case from its start on a uniform mesh."""
        mesh = self._mesh(f"uniform-{cells}.nc", MeshRequest(cells))
        return self._run(name, self._plan.case, mesh, days)

    def following(self, before: Round) -> Round:
        """The round on a mesh made for what the round `before` shows."""
        plan, number = self._plan, before.number + 1
        energy = plan.folder / f"energy-{number}.nc"
        if not energy.exists():
            write_energy(before.run, energy)
        mesh = self._mesh(
            f"mesh-{number}.nc", request_for(plan.cells, energy, MESH_TOLERANCE, plan.density_floor, plan.density_power)
        )
        if plan.begin_again:
            return Round(number, 0.0, self._run(f"round-{number}", plan.case, mesh, plan.days))
        first_day = before.first_day + plan.days
        target = mesh.scaled(plan.case.radius)
        fields = before.run.last_snapshot().fields
        reached = State(fields["thickness"], fields["normal_velocity"])
        state = carried_over(plan.case, reached, before.run.mesh, target, before.run.sampling)
        case = Continued(plan.case, first_day, state)
        return Round(number, first_day, self._run(f"round-{number}", case, mesh, plan.days))

    def _mesh(self, name: str, request: MeshRequest) -> VoronoiMesh:
        """The mesh of this name, made if the folder has none."""
        path = self._plan.folder / name
        if not path.exists():
            self._tell(f"{name}: {request.cells} cells")
            write_mesh(self._made(request), path)
        return read_mesh(path)

    def _made(self, request: MeshRequest) -> VoronoiMesh:
        with warnings.catch_warnings():
            # The energy is known wherever a mesh is asked for.
            warnings.filterwarnings("ignore", ".*covers a part of the globe", MeshWarning)
            if self._region is None:
                return generate_mesh(request).mesh
            return region_mesh(self._region, request, smoothing=self._smoothing)

    def _run(self, name: str, case: Case, mesh: VoronoiMesh, days: float) -> Run:
        """The run of this name, made unless it is there already."""
        plan = self._plan
        task = Task(
            plan.folder / name,
            case,
            mesh,
            days,
            plan.snapshot_days,
            scheme=plan.scheme,
            diagnostics_interval=plan.diagnostics_interval,
        )
        run, reason = task.carry_out(self._progress, self._tell)
        if run is None:
            raise RunError(f"{name} of {plan.folder}: {reason}")
        return run
