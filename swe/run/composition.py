"""From the fields of a case and the options of a run to the model: time step, terms, method and warnings."""

from collections.abc import Iterator, Sequence

import numpy as np

from mesh.discrete.walls import closed_mesh
from mesh.plain import plain_number
from swe.configuration import Configuration, Options
from swe.constants import SECONDS_PER_DAY
from swe.equations.anticipation import Anticipation
from swe.equations.consistent import Consistent
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.model import ShallowWaterModel, courant_number
from swe.equations.schemes import Ringler2010, Scheme
from swe.equations.soundness import thin_vertices, warning_of_vertices
from swe.equations.terms import Term
from swe.equations.upwinding import Upwinding
from swe.errors import InputError
from swe.integrators import STEPPINGS, Integrator
from swe.parallel.processes import ONE_PROCESS, Processes
from swe.run.case import CaseFields
from swe.state import State
from swe.stepping.forward_backward import ForwardBackward
from swe.stepping.schedule import dividing_step
from swe.stepping.time_stepping import RungeKutta
from swe.tiles.forward_backward import FusedForwardBackward
from swe.tiles.fused import FusedMethod, FusedRungeKutta

SCHEMES: dict[str, type[Scheme]] = {scheme.name: scheme for scheme in (Ringler2010, Consistent)}
"""Schemes by the names that a user gives."""


MOST_EVENTS = 1e9
"""Most steps, snapshots or rows of a run; more of them would take years."""

TERMS: dict[str, type[Term]] = {
    "anticipation": Anticipation,
    "upwinding": Upwinding,
    "dissipation": BiharmonicDissipation,
}
"""Terms by the options that ask for them."""


def rings_needed(options: Options) -> int:
    """Rings of cells round those of a process on which its tendencies and diagnostics depend (`mesh.parts`).

    Values are exchanged after each stage and each term, so what needs most rings decides. Tiles read the cells round
    the vertices of the neighbours of their own, two rings (`swe.tiles.cutting`); where they read all sides of the cells
    of the second one, a third must stand behind these.
    """
    asked = [term.rings for name, term in TERMS.items() if getattr(options, name) > 0.0]
    return max(SCHEMES[options.scheme].rings, *asked, 0)


def default_time_step(start: CaseFields, options: Options, processes: Processes = ONE_PROCESS) -> float:
    """Largest step, s, up to the integrator's default Courant number that divides the shorter output interval.

    The terms of the case may ask for a shorter one (`Forcing.stable_step`).
    """
    case, interval = start.case, min(options.snapshot_interval, options.diagnostics_interval)
    per_second = courant_number(
        closed_mesh(start.mesh), start.state, case.gravity, case.prescribed_wind, 1.0, processes
    )
    if not np.isfinite(per_second):
        raise InputError(f"the wave speed of {case.name} is not finite; correct its parameters")
    courant = STEPPINGS[options.integrator].default_courant_number
    per_term = (1.0 / term.at_walls(options.wall_slip).stable_step(start.mesh) for term in start.forcings)
    (of_terms,) = processes.largest(np.array([max(per_term, default=0.0)]))
    limits = [courant / per_second] if per_second > 0.0 else []
    limits += [1.0 / float(of_terms)] if of_terms > 0.0 else []
    # Where nothing moves, under a prescribed wind of zero, any step will do.
    return dividing_step(min(limits), interval) if limits else interval


def require_keeping_energy(integrator: Integrator, terms: Sequence[Term]) -> None:
    """Raise `InputError` if relaxation would undo what terms in the stages do to energy."""
    changing = [term.name for term in terms if "total_energy" in term.changes and not term.after_steps]
    if STEPPINGS[integrator].relaxed and changing:
        raise InputError(
            f"{integrator} keeps total energy, which the term {changing[0]} changes; take the integrator "
            f"{integrator.removeprefix('r')}"
        )


def day_of_end(days: float | None, until: float | None, time: float) -> float:
    """The day, counted from the start, on which a run ends that lasts `days` from `time`, s, or `until` a day."""
    if (days is None) == (until is None):
        raise InputError("give the days that the run goes on, run(days=...), or the day of its end, run(until=...)")
    if until is not None:
        return plain_number("the day of the end", until, InputError)
    return time / SECONDS_PER_DAY + plain_number("the number of days", days, InputError)


def require_possible_counts(configuration: Configuration, checkpoint_interval: float, seconds: float) -> None:
    """Raise `InputError` if a run over `seconds` would never come to its end."""
    for what, interval in (
        ("snapshot interval", configuration.snapshot_interval),
        ("diagnostics interval", configuration.diagnostics_interval),
        ("checkpoint interval", checkpoint_interval),
        ("time step", configuration.time_step),
    ):
        if seconds > MOST_EVENTS * interval:
            raise InputError(
                f"the {what} is {interval:g} s, of which {seconds / SECONDS_PER_DAY:g} days would have "
                f"{seconds / interval:.1g}; give a longer one, or fewer days"
            )


def build_model(
    start: CaseFields, configuration: Configuration, processes: Processes = ONE_PROCESS
) -> ShallowWaterModel:
    """The equations of a case with the terms that the options and the case ask for."""
    terms: list[Term] = []
    if configuration.anticipation > 0.0:
        terms.append(Anticipation(closed_mesh(start.mesh), configuration.anticipation * configuration.time_step))
    if configuration.upwinding > 0.0:
        terms.append(Upwinding(closed_mesh(start.mesh), configuration.upwinding))
    if configuration.dissipation > 0.0:
        terms.append(BiharmonicDissipation(start.mesh, configuration.dissipation, configuration.wall_slip))
    terms += start.forcings
    case = start.case
    return ShallowWaterModel(
        start.mesh,
        start.topography,
        start.coriolis,
        case.gravity,
        case.prescribed_wind,
        SCHEMES[configuration.scheme],
        terms,
        processes,
        configuration.wall_slip,
    )


def plain_method(model: ShallowWaterModel, state: State, integrator: Integrator) -> RungeKutta | ForwardBackward:
    """The method of the integrator in plain loops, for any model."""
    if STEPPINGS[integrator].forward_backward:
        return ForwardBackward(model, state, model.processes)
    return RungeKutta(model.tendency, state, processes=model.processes)


def fused_method(model: ShallowWaterModel, integrator: Integrator) -> FusedMethod:
    """The method of the integrator in loops over tiles, for models that they compute (`why_not_fused`)."""
    return FusedForwardBackward(model) if STEPPINGS[integrator].forward_backward else FusedRungeKutta(model)


def warnings_before(
    start: CaseFields, model: ShallowWaterModel, configuration: Configuration, initial_courant_number: float
) -> Iterator[str]:
    """What is likely to go wrong during a run, in sentences."""
    time_step = configuration.time_step
    waves = time_step * STEPPINGS[configuration.integrator].stable_courant_number / max(initial_courant_number, 1e-300)
    limits = {term.name: term.stable_step(start.mesh) for term in model.forcings}
    limits |= {term.name: term.largest_time_step for term in model.terms if isinstance(term, BiharmonicDissipation)}
    term = min(limits, key=lambda name: limits[name], default="")
    damping = limits.get(term, float("inf"))
    if time_step > min(waves, damping):
        cause = (
            f"the Courant number is {initial_courant_number:.3g}"
            if waves < damping
            else f"it is long for the {term.replace('_', ' ')}"
        )
        yield (
            f"a time step of {time_step:g} s is likely to be unstable, as {cause}; one of "
            f"{0.95 * min(waves, damping):.3g} s would do"
        )
    if start.kites_matter:
        thin = thin_vertices(model.closed, start.state.thickness, model.processes)
        if thin:
            yield warning_of_vertices(thin)
