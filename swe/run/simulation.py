"""The run loop: clock, schedules, progress and the watch over the state."""

import os
import warnings
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any, Protocol

import numpy as np

from mesh.arrays import Array
from mesh.integrals.quadrature import Sampling
from mesh.plain import plain_number, plain_path
from mesh.voronoi_mesh import VoronoiMesh
from swe.configuration import (
    DEFAULT_CHECKPOINT_INTERVAL,
    DEFAULT_DIAGNOSTICS_INTERVAL,
    DEFAULT_SNAPSHOT_INTERVAL,
    Integrator,
    Options,
)
from swe.constants import SECONDS_PER_DAY
from swe.diagnostics.invariants import Invariants, measure_invariants
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.model import STABLE_COURANT_NUMBER, ShallowWaterModel, check_field
from swe.equations.soundness import has_negative_kites, problem_at_vertices, problem_with_state, warning_of_vertices
from swe.errors import InputError, RunError, RunStopped, SetupWarning
from swe.output.recorder import Moment, Recorder, RunDescription, start_hash
from swe.run.memory import return_freed_memory
from swe.run.progress import ProgressBar
from swe.run.signals import StopRequest, stop_requests
from swe.run.threads import worthwhile_threads
from swe.state import State
from swe.stepping.relaxation import Relaxation
from swe.stepping.schedule import Schedule, dividing_step, last_shared
from swe.stepping.steppers import DissipatingMethod, FixedSteps, RelaxedSteps, Stepper
from swe.stepping.time_stepping import RungeKutta
from swe.tiles.fused import FusedRungeKutta

DEFAULT_COURANT_NUMBER = 0.8
"""Courant number of the default time step, 70 percent of the limit for gravity waves (`courant_number`)."""

CELL_STEPS_PER_CALL = 400_000
"""Cells times steps between two looks at signals and the bar of progress: some twentieth of a second."""

MOST_EVENTS = 1e9
"""Steps, snapshots or rows of a run; more of them take years."""


class Case(Protocol):
    """What a simulation asks of a test case: see `cases.base.Case`."""

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
        """Whether the wind stays as it is at the start, so that only thickness evolves."""

    def initial_state(self, mesh: VoronoiMesh, sampling: Sampling) -> State:
        """State at time zero, thickness at the centres of cells or the mean over each."""

    def topography_on(self, mesh: VoronoiMesh, sampling: Sampling) -> Array:
        """Height of the bottom at the centres of cells or the mean over each, m."""

    def coriolis_on(self, mesh: VoronoiMesh) -> Array:
        """Coriolis parameter at vertices, 1/s."""

    def parameters(self) -> dict[str, float]:
        """Parameters of the case by name, for the record of the run."""


class Simulation:
    """One run of a case on a mesh.

    Parameters
    ----------
    mesh
        Any Voronoi mesh; it is scaled to the radius of the case.
    case
        A test case, such as those of `cases`.
    output
        Run directory to create; nothing is written if None. Refused where it holds a run already, unless
        `overwrite` or `resume`.
    time_step
        Seconds; by default the largest up to `DEFAULT_COURANT_NUMBER` that divides the shorter output interval.
        Steps are shortened where they would pass an output time. Warns with `SetupWarning` where it is unstable.
    snapshot_interval, diagnostics_interval
        Seconds between snapshots and between rows of diagnostics.
    checkpoint_interval
        Simulated seconds between checkpoints; results do not depend on it.
    sampling
        "point" where initial thickness and topography are those of the cells' centres, "mean" where they are means
        over the cells.
    integrator
        "rk4", the classical method, or "rrk4", whose steps are relaxed to keep total energy (`Relaxation`).
    anticipation
        Part of the time step by which potential vorticity is anticipated, 0.5 in the literature, so that potential
        enstrophy decays at no cost in energy (Sadourny and Basdevant 1985); plain loops then take the steps.
    dissipation
        Coefficient of the biharmonic dissipation, m4/s, applied after each step.
    overwrite
        Whether to replace a run that the directory holds.
    resume
        Whether to go on from the last checkpoint of the run that the directory holds, to the files that the run would
        have left without a stop, bit for bit; from the start where there is no checkpoint.

    Raises
    ------
    InputError
        Where an option is out of range, the case gives no sound fields, the initial thickness is not positive, the
        directory cannot be used, or the run to go on with was made with another mesh, case or option.
    """

    def __init__(
        self,
        mesh: VoronoiMesh,
        case: Case,
        output: str | os.PathLike[str] | None = None,
        *,
        time_step: float | None = None,
        snapshot_interval: float = DEFAULT_SNAPSHOT_INTERVAL,
        diagnostics_interval: float = DEFAULT_DIAGNOSTICS_INTERVAL,
        checkpoint_interval: float = DEFAULT_CHECKPOINT_INTERVAL,
        sampling: Sampling = "point",
        integrator: Integrator = "rk4",
        anticipation: float = 0.0,
        dissipation: float = 0.0,
        overwrite: bool = False,
        resume: bool = False,
    ) -> None:
        options = Options(
            time_step,
            snapshot_interval,
            diagnostics_interval,
            checkpoint_interval,
            sampling,
            integrator,
            anticipation,
            dissipation,
        )
        options.require_suitable(case.name, case.prescribed_wind)
        directory = None if output is None else plain_path("output", output, InputError)
        self.case = case
        self.mesh = mesh.scaled(case.radius)
        options.require_suitable_mesh(self.mesh)
        topography = _asked(case, case.topography_on, self.mesh, options.sampling)
        coriolis = _asked(case, case.coriolis_on, self.mesh)
        self.model = ShallowWaterModel(self.mesh, topography, coriolis, case.gravity, case.prescribed_wind)
        self._kites_matter = has_negative_kites(self.mesh) and not case.prescribed_wind
        self.state = self._initial_state(options.sampling)
        self.time = 0.0
        self.steps = 0
        self._broken = False
        step = options.time_step or self._default_time_step(
            min(options.snapshot_interval, options.diagnostics_interval)
        )
        self.configuration = options.with_time_step(step)
        self.checkpoint_interval = options.checkpoint_interval
        self.initial_courant_number = self.courant_number = self.model.courant_number(self.state, step)
        self.initial_invariants = self.invariants
        self._require_finite_integrals()
        if options.anticipation > 0.0:
            self.model = self.model.anticipating(options.anticipation * step)
        self.dissipation = BiharmonicDissipation(self.model, options.dissipation) if options.dissipation > 0.0 else None
        self._warn_of_instability()
        thin = warning_of_vertices(self.mesh, self.state.thickness) if self._kites_matter else None
        if thin:
            warnings.warn(thin, SetupWarning, stacklevel=2)
        self.recorder = None if directory is None else Recorder(self._described(), directory, overwrite, resume)
        self.method = self._build_method()
        self.stepper = self._build_stepper()
        reached = None if self.recorder is None else self.recorder.restore()
        if reached is not None:
            self.set_back_to(reached.state, reached.time, reached.steps)
        return_freed_memory()

    def __repr__(self) -> str:
        place = "" if self.recorder is None else f", written to {self.recorder.directory}"
        return (
            f"<Simulation of {self.case.name} on {self.mesh.n_cells} cells: day {self.time / SECONDS_PER_DAY:g}, "
            f"{self.steps} steps, time step {self.configuration.time_step:g} s{place}>"
        )

    def _initial_state(self, sampling: Sampling) -> State:
        """The state at time zero; raises `InputError` where it is not sound."""
        case, mesh = self.case, self.mesh
        state = _asked(case, case.initial_state, mesh, sampling)
        if not isinstance(state, State):
            raise InputError(f"initial_state of {case.name} gives {type(state).__name__}; it must give a State")
        check_field("initial thickness", state.thickness, mesh.n_cells)
        check_field("initial normal velocity", state.normal_velocity, mesh.n_edges)
        problem = problem_with_state(mesh, state)
        if problem:
            raise InputError(f"the initial {problem}; correct the parameters of {case.name}")
        problem = problem_at_vertices(mesh, state.thickness) if self._kites_matter else None
        if problem:
            raise InputError(f"the initial {problem}")
        return state

    def _require_finite_integrals(self) -> None:
        """Raise `InputError` where a global integral is beyond the numbers, so that no change of it can be told."""
        for name, value in vars(self.initial_invariants).items():
            if not np.isfinite(value):
                raise InputError(
                    f"the initial {name.replace('_', ' ')} is {value:g}, beyond the range of numbers; correct the "
                    f"parameters of {self.case.name}"
                )

    def set_back_to(self, state: State, time: float, steps: int) -> None:
        """Go on from `state` at `time`, seconds, after `steps` steps; keeps the arrays of the present state."""
        self.state.thickness[:] = state.thickness
        self.state.normal_velocity[:] = state.normal_velocity
        self.time, self.steps = time, steps

    def set_back_to_start(self) -> None:
        """Go on from the initial state."""
        self.set_back_to(self._initial_state(self.configuration.sampling), 0.0, 0)
        self.courant_number = self.initial_courant_number

    def _default_time_step(self, interval: float) -> float:
        """Largest step up to the default Courant number that divides `interval`."""
        per_second = self.model.courant_number(self.state, 1.0)
        if not np.isfinite(per_second):
            raise InputError(f"the waves of {self.case.name} are too fast for numbers; correct its parameters")
        # Where nothing moves, under a prescribed wind of zero, any step does.
        return dividing_step(DEFAULT_COURANT_NUMBER / per_second, interval) if per_second > 0.0 else interval

    def _build_method(self) -> FusedRungeKutta | RungeKutta:
        """The fused method, or its plain twin where the tendency anticipates potential vorticity."""
        if self.model.anticipation == 0.0:
            return FusedRungeKutta(self.model)
        return RungeKutta(self.model.tendency, self.state)

    def _build_stepper(self) -> Stepper:
        if self.configuration.integrator == "rrk4":
            return RelaxedSteps(self.method, Relaxation(self.model, self.state), self.state, self.dissipation)
        if self.dissipation is not None:
            return FixedSteps(DissipatingMethod(self.method, self.dissipation))
        return FixedSteps(self.method)

    def _warn_of_instability(self) -> None:
        time_step = self.configuration.time_step
        waves = time_step * STABLE_COURANT_NUMBER / max(self.initial_courant_number, 1e-300)
        damping = float("inf") if self.dissipation is None else self.dissipation.largest_time_step
        if time_step > min(waves, damping):
            cause = (
                f"the Courant number is {self.initial_courant_number:.3g}"
                if waves < damping
                else "it is long for the dissipation"
            )
            warnings.warn(
                f"a time step of {time_step:g} s is likely to be unstable, as {cause}; one of "
                f"{0.95 * min(waves, damping):.3g} s would do",
                SetupWarning,
                stacklevel=3,
            )

    @property
    def invariants(self) -> Invariants:
        """Invariants of the present state."""
        return measure_invariants(self.model, self.state, self.model.diagnose(self.state))

    def run(self, days: float, progress: bool = True) -> None:
        """Integrate to `days` after the start, writing output on the way.

        A run that goes on (`resume`) may have another end than before: it then leaves the files of one run to `days`,
        bit for bit, for which it may first go back to the last time that both have in common.

        Raises `InputError` where `days` is before now, `RunError` where the state ceases to be finite or the thickness
        to be positive, or where output cannot be written, and `RunStopped` between two steps some twentieth of a second
        after Ctrl-C or SIGTERM; a second one interrupts at once. What was written before stays. After all of these but
        `RunStopped`, what the object holds is no state to go on from.
        """
        days = plain_number("the number of days", days, InputError)
        end = days * SECONDS_PER_DAY
        if self._broken:
            again = "" if self.recorder is None else ", with resume=True"
            raise InputError(f"the run broke off and cannot go on; make the simulation again{again}")
        resumed = self.recorder is not None and self.recorder.resumed
        if not (np.isfinite(end) and (end > self.time or (resumed and end == self.time))):
            raise InputError(
                f"the run stands at day {self.time / SECONDS_PER_DAY:g} and cannot go to day {days:g}; give a later day"
            )
        self._require_possible_counts(end - self.time)
        if self.recorder is not None:
            self._choose_end(self.recorder, days)
        with (
            worthwhile_threads(self.mesh.n_cells),
            stop_requests() as request,
            ProgressBar(self.time / SECONDS_PER_DAY, days, progress) as bar,
        ):
            recording = nullcontext() if self.recorder is None else self._recording(self.recorder, days)
            with recording:
                self._broken = True
                try:
                    self._run_to(end, bar, request)
                except RunStopped:
                    self._broken = False
                    raise
            self._broken = False

    def _described(self) -> RunDescription:
        """What the recorder must know of the run; to be called before the first step."""
        return RunDescription(
            self.case.name,
            self.case.parameters(),
            self.configuration,
            self.model,
            self.dissipation,
            start_hash(self.model, self.state),
            self.initial_invariants,
        )

    def _now(self) -> Moment:
        return Moment(self.time, self.steps, self.state, self.courant_number, self.method.tendency)

    def _recording(self, recorder: Recorder, days: float) -> AbstractContextManager[None]:
        return recorder.recording(days, self.last_shared_time(days), self._now)

    def _choose_end(self, recorder: Recorder, days: float) -> None:
        """Give a run that goes on another end, if it had one: go back to where a run to `days` has been as well."""
        before = recorder.other_end(days)
        if before is None:
            return
        reached = recorder.restore_shared(days, min(self.last_shared_time(before), self.last_shared_time(days)))
        if reached is None:
            self.set_back_to_start()
        else:
            self.set_back_to(reached.state, reached.time, reached.steps)

    def _require_possible_counts(self, seconds: float) -> None:
        """Raise `InputError` where the run would never come to its end."""
        configuration = self.configuration
        for what, interval in (
            ("snapshot interval", configuration.snapshot_interval),
            ("diagnostics interval", configuration.diagnostics_interval),
            ("checkpoint interval", self.checkpoint_interval),
            ("time step", configuration.time_step),
        ):
            if seconds > MOST_EVENTS * interval:
                raise InputError(
                    f"the {what} is {interval:g} s, of which {seconds / SECONDS_PER_DAY:g} days would have "
                    f"{seconds / interval:.1g}; give a longer one, or fewer days"
                )

    def last_shared_time(self, days: float) -> float:
        """The last time, seconds, at which a run to `days` has done what any longer one has done (`last_shared`)."""
        return last_shared(self._schedules(days * SECONDS_PER_DAY))

    def _schedules(self, end: float) -> tuple[Schedule, Schedule]:
        """When snapshots and diagnostics are due."""
        configuration = self.configuration
        return Schedule(configuration.snapshot_interval, end), Schedule(configuration.diagnostics_interval, end)

    def _run_to(self, end: float, bar: ProgressBar, request: StopRequest) -> None:
        snapshots, diagnostics = self._schedules(end)
        shared = last_shared((snapshots, diagnostics))
        checkpoints = Schedule(self.checkpoint_interval, float("inf"))
        due = checkpoints.next_after(self.time)
        while self.time < end:
            event = min(snapshots.next_after(self.time), diagnostics.next_after(self.time))
            self._advance(event)
            if self.time == event:
                self.courant_number = self.model.courant_number(self.state, self.configuration.time_step)
                bar.show_courant_number(self.courant_number)
                if self.recorder is not None:
                    self.recorder.record(self._now(), snapshots.is_due(self.time), diagnostics.is_due(self.time))
            bar.update(self.time / SECONDS_PER_DAY)
            if self.recorder is not None:
                if self.time == shared and (shared < end or self.time < due):
                    self.recorder.checkpoint(self._now(), shared=True)
                if self.time >= due or request.signal is not None or self.time == end > shared:
                    self.recorder.checkpoint(self._now())
                    due = checkpoints.next_after(self.time)
            if self.time < end:
                request.raise_if_any(
                    self.time / SECONDS_PER_DAY,
                    "nothing is kept, as it has no run directory"
                    if self.recorder is None
                    else f"its checkpoint is in {self.recorder.directory}",
                )

    def _advance(self, event: float) -> None:
        """Take some steps towards `event`, seconds, which none passes."""
        most = max(1, CELL_STEPS_PER_CALL // self.mesh.n_cells)
        before, start = self.state.copy() if self._kites_matter else None, self.time
        self.time, taken = self.stepper.advance(self.state, start, event, self.configuration.time_step, most)
        self.steps += taken
        if self.stepper.unsound:
            if before is not None:
                self._explain_by_vertices(before, start, event, taken)
            raise RunError(
                f"at day {self.time / SECONDS_PER_DAY:.3f}, step {self.steps}, the "
                f"{problem_with_state(self.mesh, self.state)}; "
                f"the Courant number was {self.initial_courant_number:.3g} at the start: where that is above "
                f"{DEFAULT_COURANT_NUMBER}, a smaller time step than {self.configuration.time_step:g} s helps"
            )

    def _explain_by_vertices(self, before: State, time: float, event: float, steps: int) -> None:
        """Take the last `steps` steps again from `before`; raise `RunError` where a vertex goes wrong first."""
        for step in range(self.steps - steps + 1, self.steps + 1):
            time, _ = self.stepper.advance(before, time, event, self.configuration.time_step, 1)
            problem = problem_at_vertices(self.mesh, before.thickness)
            if problem:
                raise RunError(f"at day {time / SECONDS_PER_DAY:.3f}, step {step}, the {problem}")


def _asked(case: Case, function: Callable[..., Any], *arguments: object) -> Any:
    """What `function` of the case gives; a case may be of the user, and fail in any way."""
    try:
        return function(*arguments)
    except (InputError, MemoryError):
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{function.__name__} of {case.name} failed: {error!r}") from error
