"""The run loop: clock, schedules, progress and the watch over the state."""

import os
import warnings
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext
from functools import partial

import numpy as np

from mesh.arrays import Array
from mesh.integrals.quadrature import Sampling
from mesh.plain import plain_path
from mesh.shown import Rows, Shown
from mesh.voronoi_mesh import VoronoiMesh
from swe.configuration import (
    DEFAULT_CHECKPOINT_INTERVAL,
    DEFAULT_DIAGNOSTICS_INTERVAL,
    DEFAULT_SNAPSHOT_INTERVAL,
    Options,
    SchemeName,
)
from swe.constants import SECONDS_PER_DAY
from swe.damping.over_tiles import terms_over_tiles
from swe.diagnostics.invariants import Invariants, measure_invariants
from swe.diagnostics.outputs import chosen_fields
from swe.equations.soundness import problem_at_vertices, problem_with_state
from swe.errors import InputError, RunError, RunStopped, SetupWarning
from swe.integrators import STEPPINGS, Integrator, Stepping
from swe.output.description import Moment, RunDescription, start_hash
from swe.output.recorder import Recorder
from swe.parallel.processes import ONE_PROCESS, Processes, anywhere
from swe.run.case import Case, case_fields, initial_state, require_finite_integrals
from swe.run.composition import (
    build_model,
    day_of_end,
    default_time_step,
    fused_method,
    plain_method,
    require_keeping_energy,
    require_possible_counts,
    warnings_before,
)
from swe.run.memory import return_freed_memory
from swe.run.progress import ProgressBar
from swe.run.shown import rows_of_simulation
from swe.run.signals import StopRequest, stop_requests
from swe.run.threads import worthwhile_threads
from swe.run.watch import Callback, Watch
from swe.state import State
from swe.stepping.forward_backward import ForwardBackward
from swe.stepping.relaxation import Relaxation
from swe.stepping.schedule import Schedule, last_shared
from swe.stepping.steppers import FixedSteps, RelaxedSteps, Stepper, followed_by
from swe.stepping.time_stepping import RungeKutta
from swe.tiles.fused import FusedMethod, why_not_fused

CELL_STEPS_PER_CALL = 400_000
"""Cells of a process times steps between two checks for signals, and updates of the progress bar: some 50 ms."""


class Simulation(Shown):
    """One run of a case on a mesh.

    Parameters
    ----------
    mesh
        Any Voronoi mesh; it is scaled to the radius of the case.
    case
        A test case, such as those of `cases`.
    output
        Run directory to create; nothing is written if None. Refused if it already holds a run, unless `overwrite` or
        `resume`.
    time_step
        Seconds; by default the largest up to 70 percent of the integrator's limit (`swe.integrators`) that divides the
        shorter output interval. Steps are shortened where they would pass an output time. Warns with `SetupWarning` if
        it is unstable.
    snapshot_interval, diagnostics_interval
        Seconds between snapshots and between rows of diagnostics.
    checkpoint_interval
        Simulated seconds between checkpoints; results do not depend on it.
    sampling
        "point" takes initial thickness and topography at cell centres, "mean" takes their means over the cells.
    integrator
        "rk4", the classical method, or "fbrk3", the forward-backward one (`FB_RK32`), of lower order but with longer
        and cheaper steps; "rrk4" and "rfbrk3" are the same, relaxed to conserve total energy (`Relaxation`).
    anticipation
        Fraction of the time step by which potential vorticity is anticipated, 0.5 in the literature, so that potential
        enstrophy decays at no cost in energy (Sadourny and Basdevant 1985).
    dissipation
        Coefficient of the biharmonic dissipation, m4/s, applied after each step.
    scheme
        "ringler2010", that of the published results, or "consistent", whose kinetic energy is exact for uniform flow on
        cells of any shape, and whose errors therefore stay small on irregular meshes (`swe.equations.consistent`).
    upwinding
        How far potential vorticity is blended towards the value upstream, from 0 to 1, so that potential enstrophy
        decays at no cost in energy and whatever the time step (`swe.equations.upwinding`).
    wall_slip
        Slip along coasts, from 0 (no slip) to 1 (free slip): how much of the circulation at coasts is not vorticity of
        the fluid (`docs/scheme.md`). Meshes without a coast do not know it.
    fields
        Names of the fields in snapshots, from `swe.diagnostics.outputs.FIELDS`; all of them by default.
    overwrite
        Whether to replace a run in the directory.
    resume
        Whether to resume the run in the directory from its last checkpoint, or from the start if it has none. The files
        are then those of an uninterrupted run, bit for bit.
    processes
        Those that share the run; `mesh` is then this one's part of the mesh (`mesh.parts`).

    Attributes
    ----------
    model, method, stepper, recorder
        The equations with their terms, the Runge-Kutta method, what takes it from one output to the next, and what
        writes output. The model is built from the fields of the case, and each of the others from the one before.
    loops
        "fused", or "plain" if the model has a term that the fused loops over tiles do not compute: several times
        slower, with the same results to round-off.

    Raises
    ------
    InputError
        If an option is out of range, the fields of the case are invalid, the initial thickness is not positive, the
        directory cannot be used, or the run to resume was made with another mesh, case or option.
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
        scheme: SchemeName = "ringler2010",
        upwinding: float = 0.0,
        wall_slip: float = 0.0,
        fields: Iterable[str] | None = None,
        overwrite: bool = False,
        resume: bool = False,
        processes: Processes = ONE_PROCESS,
    ) -> None:
        options = Options(
            *(time_step, snapshot_interval, diagnostics_interval, checkpoint_interval, sampling, integrator),
            *(anticipation, dissipation, scheme, upwinding, wall_slip),
        )
        options.require_suitable(case.name, case.prescribed_wind)
        output_fields = chosen_fields(fields)
        directory = None if output is None else plain_path("output", output, InputError)
        self.case = case
        self._start = start = case_fields(case, mesh, options.sampling, processes)
        self.mesh, self.state = start.mesh, start.state
        processes.together(lambda: options.require_suitable_mesh(self.mesh))
        require_keeping_energy(options.integrator, start.forcings)
        self.time, self.steps = 0.0, 0
        self._broken = False
        self.configuration = options.with_time_step(options.time_step or default_time_step(start, options, processes))
        self.checkpoint_interval = options.checkpoint_interval

        self.model = build_model(start, self.configuration, processes)
        processes.exchange(self.state)
        self.initial_courant_number = self.courant_number = self._present_courant_number()
        self.initial_invariants = self.invariants
        require_finite_integrals(vars(self.initial_invariants), case.name)
        for warning in warnings_before(start, self.model, self.configuration, self.initial_courant_number):
            warnings.warn(warning, SetupWarning, stacklevel=2)
        self.loops = "fused" if why_not_fused(self.model, options.integrator) is None else "plain"
        description = self._described(output_fields)
        self.recorder = None if directory is None else Recorder(description, directory, overwrite, resume)
        self.method = self._build_method()
        self.stepper = self._build_stepper()
        reached = None if self.recorder is None else self.recorder.restore()
        if reached is not None:
            self.set_back_to(reached.state, reached.time, reached.steps)
        return_freed_memory()

    def _title_and_rows(self) -> tuple[str, Rows]:
        directory = None if self.recorder is None else self.recorder.directory
        rows = rows_of_simulation(self.case, self.model, self.configuration, self.loops, self._now(), directory)
        return f"Simulation of {self.case.name}", rows

    def set_back_to(self, state: State, time: float, steps: int) -> None:
        """Continue from `state` at `time`, seconds, after `steps` steps; keeps the arrays of the present state."""
        self.state.thickness[:] = state.thickness
        self.state.normal_velocity[:] = state.normal_velocity
        self.time, self.steps = time, steps

    def set_back_to_start(self) -> None:
        """Continue from the initial state."""
        start, sampling, processes = self._start, self.configuration.sampling, self.model.processes
        self.set_back_to(initial_state(self.case, self.mesh, sampling, start.kites_matter, processes), 0.0, 0)
        processes.exchange(self.state)
        self.courant_number = self.initial_courant_number

    @property
    def _stepping(self) -> Stepping:
        return STEPPINGS[self.configuration.integrator]

    def _build_method(self) -> FusedMethod | RungeKutta | ForwardBackward:
        integrator = self.configuration.integrator
        if self.loops == "fused":
            return fused_method(self.model, integrator)
        return plain_method(self.model, self.state, integrator)

    def _build_stepper(self) -> Stepper:
        terms = self.model.terms_after_steps
        if self.loops == "fused":
            terms = terms_over_tiles(self.mesh, terms)
        processes = self.model.processes
        if self._stepping.relaxed:
            return RelaxedSteps(self.method, Relaxation(self.model, self.state), self.state, terms, processes)
        return FixedSteps(followed_by(terms, self.method, processes))

    def _present_courant_number(self) -> float:
        return self.model.courant_number(self.state, self.configuration.time_step)

    @property
    def invariants(self) -> Invariants:
        """Invariants of the present state."""
        return measure_invariants(self.model, self.state, self.model.diagnose(self.state))

    def run(
        self,
        days: float | None = None,
        progress: bool = True,
        *,
        until: float | None = None,
        callbacks: Iterable[Callback] = (),
        stop_when: Callable[["Simulation"], bool] | None = None,
    ) -> None:
        """Integrate for another `days` days, or `until` a day counted from the start, writing output on the way.

        A resumed run (`resume`) may have a different end from before. Its files are then those of a single run to that
        day, bit for bit; for this it may first go back to the last time that both runs share.

        The `callbacks` are called on their schedules, and `stop_when` is evaluated after each step: once it is true,
        the run ends there, with a checkpoint from which it can resume. Neither changes the steps that are taken.

        Raises `InputError` if the end is before the present time, `RunError` if the state ceases to be finite or the
        thickness to be positive, or if output cannot be written, and `RunStopped` between two steps about a twentieth
        of a second after Ctrl-C or SIGTERM; a second signal interrupts at once. Output already written stays. After any
        of these but `RunStopped`, the object no longer holds a state from which a run can continue.
        """
        last_day = day_of_end(days, until, self.time)
        end = last_day * SECONDS_PER_DAY
        if self._broken:
            again = "" if self.recorder is None else ", with resume=True"
            raise InputError(f"the run broke off and cannot go on; make the simulation again{again}")
        resumed = self.recorder is not None and self.recorder.resumed
        if not (np.isfinite(end) and (end > self.time or (resumed and end == self.time))):
            raise InputError(
                f"the run stands at day {self.time / SECONDS_PER_DAY:g} and cannot go to day {last_day:g}; give a "
                "later day"
            )
        require_possible_counts(self.configuration, self.checkpoint_interval, end - self.time)
        if self.recorder is not None:
            self._choose_end(self.recorder, last_day)
        watch, processes = Watch(self, self.time, callbacks, stop_when), self.model.processes
        with (
            worthwhile_threads(self.mesh.n_cells),
            stop_requests(processes) as request,
            ProgressBar(self.time / SECONDS_PER_DAY, last_day, progress and processes.first) as bar,
        ):
            recording = nullcontext() if self.recorder is None else self._recording(self.recorder, last_day)
            with recording:
                self._broken = True
                try:
                    self._run_to(end, bar, request, watch)
                except RunStopped:
                    self._broken = False
                    raise
            self._broken = False

    def _described(self, fields: tuple[str, ...]) -> RunDescription:
        """What the recorder must know about the run, whose snapshots hold `fields`; called before the first step."""
        return RunDescription(
            self.case.name,
            self.case.parameters(),
            self.configuration,
            self.model,
            start_hash(self.model, self.state, self.model.forcings),
            self.initial_invariants,
            fields,
            tuple(term.name for term in self.model.forcings),
            self.loops,
        )

    def _now(self) -> Moment:
        return Moment(self.time, self.steps, self.state, self.courant_number, self.method.tendency)

    def _recording(self, recorder: Recorder, days: float) -> AbstractContextManager[None]:
        return recorder.recording(days, self.last_shared_time(days), self._now)

    def _choose_end(self, recorder: Recorder, days: float) -> None:
        """If a resumed run had another end, go back to the last state that it shares with a run to `days`."""
        before = recorder.other_end(days)
        if before is None:
            return
        reached = recorder.restore_shared(days, min(self.last_shared_time(before), self.last_shared_time(days)))
        if reached is None:
            self.set_back_to_start()
        else:
            self.set_back_to(reached.state, reached.time, reached.steps)

    def last_shared_time(self, days: float) -> float:
        """The last time, seconds, up to which a run to `days` does the same as any longer one (`last_shared`)."""
        return last_shared(self._schedules(days * SECONDS_PER_DAY))

    def _schedules(self, end: float) -> tuple[Schedule, Schedule]:
        """When snapshots and diagnostics are due."""
        configuration = self.configuration
        return Schedule(configuration.snapshot_interval, end), Schedule(configuration.diagnostics_interval, end)

    def _run_to(self, end: float, bar: ProgressBar, request: StopRequest, watch: Watch) -> None:
        snapshots, diagnostics = self._schedules(end)
        shared = last_shared((snapshots, diagnostics))
        checkpoints = Schedule(self.checkpoint_interval, float("inf"))
        due = checkpoints.next_after(self.time)
        while self.time < end:
            event = min(snapshots.next_after(self.time), diagnostics.next_after(self.time))
            self._advance(event, watch.most_steps(self.time, self.configuration.time_step))
            if self.time == event:
                self.courant_number = self._present_courant_number()
                bar.show_courant_number(self.courant_number)
                if self.recorder is not None:
                    self.recorder.record(self._now(), snapshots.is_due(self.time), diagnostics.is_due(self.time))
            bar.update(self.time / SECONDS_PER_DAY)
            request.listen()
            if self.recorder is not None:
                if self.time == shared and (shared < end or self.time < due):
                    self.recorder.checkpoint(self._now(), shared=True)
                if self.time >= due or request.signal is not None or self.time == end > shared:
                    self.recorder.checkpoint(self._now())
                    due = checkpoints.next_after(self.time)
            watch.call(self.time)
            if self.time < end and anywhere(self.model.processes, int(watch.is_over())):
                self._end_early(watch.reason)
                return
            if self.time < end:
                request.raise_if_any(
                    self.time / SECONDS_PER_DAY,
                    "nothing is kept, as it has no run directory"
                    if self.recorder is None
                    else f"its checkpoint is in {self.recorder.directory}",
                )

    def _end_early(self, reason: str) -> None:
        """Write a checkpoint where the run stands, so that it can resume from there."""
        if self.recorder is not None:
            self.recorder.checkpoint(self._now())
            self.recorder.early_end = reason

    def _advance(self, event: float, most: int) -> None:
        """Take some steps towards `event`, seconds, without passing it, and no more than `most`."""
        most = max(1, min(most, CELL_STEPS_PER_CALL * self.model.processes.count // self.model.cells))
        before, start = self.state.copy() if self._start.kites_matter else None, self.time
        self.time, taken = self.stepper.advance(self.state, start, event, self.configuration.time_step, most)
        self.steps += taken
        if self.stepper.unsound:
            if before is not None:
                self._explain_by_vertices(before, start, event, taken)
            self.model.processes.together(self._require_sound)
            raise RunError(self._failure("state is unsound"))

    def _require_sound(self) -> None:
        problem = problem_with_state(self.mesh, self.state, self.model.processes)
        if problem:
            raise RunError(self._failure(problem))

    def _failure(self, problem: str) -> str:
        """The `problem` of the present state in a sentence."""
        return (
            f"at day {self.time / SECONDS_PER_DAY:.3f}, step {self.steps}, the {problem}; "
            f"the Courant number was {self.initial_courant_number:.3g} at the start: where that is above "
            f"{self._stepping.default_courant_number:.3g}, a smaller time step than "
            f"{self.configuration.time_step:g} s helps"
        )

    def _explain_by_vertices(self, before: State, time: float, event: float, steps: int) -> None:
        """Repeat the last `steps` steps from `before`; raise `RunError` if a vertex goes wrong first."""
        processes = self.model.processes
        for step in range(self.steps - steps + 1, self.steps + 1):
            time, _ = self.stepper.advance(before, time, event, self.configuration.time_step, 1)
            processes.together(partial(self._require_sound_vertices, before.thickness, time, step))

    def _require_sound_vertices(self, thickness: Array, time: float, step: int) -> None:
        problem = problem_at_vertices(self.model.closed, thickness, self.model.processes)
        if problem:
            raise RunError(f"at day {time / SECONDS_PER_DAY:.3f}, step {step}, the {problem}")
