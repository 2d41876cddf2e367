"""What a step costs, compared with the plain loops and with the memory bandwidth of the machine."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from swe.configuration import SchemeName
from swe.damping.over_tiles import DissipationOverTiles, terms_over_tiles
from swe.equations.kernels import add_scaled
from swe.errors import InputError, RunError
from swe.integrators import Integrator
from swe.run.composition import plain_method
from swe.run.simulation import Simulation
from swe.run.threads import worthwhile_threads
from swe.stepping.steppers import followed_by
from swe.tiles.fused import FusedMethod, why_not_fused

ROUNDS = 9
"""The fused step, the plain one and the triad take turns this many times; medians are reported."""

SECONDS_PER_TURN = 0.3
"""The fused step is repeated for about this long in a turn, and the plain one half as often."""

TRIAD_SIZE = 25_000_000
"""Three arrays of 200 MB: more than the last-level cache holds."""


@dataclass(frozen=True)
class Timing:
    """Medians over alternating turns; a step is one of the `integrator` with the `scheme` and the terms named.

    `bytes_per_cell_step` counts every array once for each stage that needs it, and `gb_per_s` is that divided by the
    time. `triad_gb_per_s` is the rate of the STREAM triad (McCalpin 1995), a = b + 3 c, in the same process, with two
    arrays read and one written, and `fraction_of_triad` is the ratio of the two rates. `plain_twin_ratio` is the median
    over the turns of the plain step's time divided by that of the fused one.
    """

    cells: int
    threads: int
    ns_per_cell_step: float
    plain_ns_per_cell_step: float
    plain_twin_ratio: float
    bytes_per_cell_step: float
    gb_per_s: float
    triad_gb_per_s: float
    fraction_of_triad: float
    integrator: Integrator = "rk4"
    scheme: SchemeName = "ringler2010"
    terms: tuple[str, ...] = ()


def measure(simulation: Simulation) -> Timing:
    """Time steps of the fused and of the plain path from the state of `simulation`, which is left unchanged.

    Raises `RunError` if the state blows up, and `InputError` if plain loops alone can take the steps.
    """
    model, fused, time_step = simulation.model, simulation.method, simulation.configuration.time_step
    cells, integrator = model.mesh.n_cells, simulation.configuration.integrator
    if not isinstance(fused, FusedMethod):
        raise InputError(f"{why_not_fused(model, integrator)}: there are no fused steps to time, only plain ones")
    tiled = terms_over_tiles(model.mesh, model.terms_after_steps)
    fused_steps = followed_by(tiled, fused)
    plain_steps = followed_by(model.terms_after_steps, plain_method(model, simulation.state, integrator))
    fast, slow = simulation.state.copy(), simulation.state.copy()
    a, b, c = (np.ones(TRIAD_SIZE) for _ in range(3))
    with worthwhile_threads(cells) as threads:
        once = [_seconds(lambda: fused_steps.advance(fast, time_step), 1) for _ in range(3)]
        plain_steps.advance(slow, time_step)
        add_scaled(b, 3.0, c, a)
        repeats = max(1, round(SECONDS_PER_TURN / min(once)))
        turns = np.empty((ROUNDS, 3))
        for turn in turns:
            turn[0] = _seconds(lambda: fused_steps.advance(fast, time_step, repeats), 1) / repeats
            if fused_steps.unsound:
                raise RunError(f"the state of {simulation.case.name} on {cells} cells blew up; time on a better mesh")
            turn[1] = _seconds(lambda: plain_steps.advance(slow, time_step), max(1, repeats // 2))
            turn[2] = _seconds(lambda: add_scaled(b, 3.0, c, a), 1)
    nanoseconds, plain_nanoseconds, _ = 1e9 * np.median(turns, axis=0) / cells
    triad = 24 * TRIAD_SIZE / np.median(turns[:, 2]) / 1e9
    volume = (
        fused.bytes_per_step + sum(t.bytes_per_step for t in tiled if isinstance(t, DissipationOverTiles))
    ) / cells
    return Timing(
        cells=cells,
        threads=threads,
        ns_per_cell_step=float(nanoseconds),
        plain_ns_per_cell_step=float(plain_nanoseconds),
        plain_twin_ratio=float(np.median(turns[:, 1] / turns[:, 0])),
        bytes_per_cell_step=volume,
        gb_per_s=float(volume / nanoseconds),
        triad_gb_per_s=float(triad),
        fraction_of_triad=float(volume / nanoseconds / triad),
        integrator=integrator,
        scheme=simulation.configuration.scheme,
        terms=tuple(term.name for term in model.terms),
    )


def _seconds(work: Callable[[], object], repeats: int) -> float:
    """Seconds that `work` takes, the mean of `repeats` calls."""
    begin = time.perf_counter()
    for _ in range(repeats):
        work()
    return (time.perf_counter() - begin) / repeats
