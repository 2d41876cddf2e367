"""What a step costs on many processes: a model of its time, from real sizes of parts and the numbers of a network.

    T = compute + imbalance + halo + overhead + latency x messages + volume / bandwidth + reductions

Each process steps the cells of its part, and those of its halo that its tiles cover; after each pass over them it
exchanges values with its neighbours; and once or more in a step all agree on whether the state is sound. The slowest
process sets the pace. Messages are not hidden behind computation.
"""

from dataclasses import dataclass, fields

import numpy as np

from mesh.arrays import Array
from swe.integrators import FB_RK32, STEPPINGS, Integrator
from swe.parallel.exchange_counts import ExchangeCounts, Numbers
from swe.parallel.exchange_plan import BYTES

RK4_STAGES = 4


@dataclass(frozen=True)
class Network:
    """Seconds that a message takes on its way, whatever its size, and bytes/s of each process; defaults are typical."""

    latency: float = 2e-6
    bandwidth: float = 12e9


@dataclass(frozen=True)
class Machine:
    """What a process costs by itself: seconds for a cell and step, for a pass with its exchange, and for a byte in it.

    A pass costs the calls of compiled loops and of MPI, whatever its size; a byte that is sent costs being packed, and
    unpacked by another process. The network comes on top.
    """

    seconds_per_cell: float
    seconds_per_pass: float = 0.0
    seconds_per_byte: float = 0.0


@dataclass(frozen=True)
class StepPattern:
    """Passes over the tiles in a step, each followed by an exchange, and reductions over all processes."""

    passes: float
    reductions: int


def step_pattern(integrator: Integrator, terms_after_steps: int = 0, steps_per_call: float = 1.0) -> StepPattern:
    """The pattern of a step in loops over tiles (`swe.tiles`), followed by so many terms that act after it.

    A call of a forward-backward method begins with a pass that its other steps need not repeat; relaxed steps, and
    those that terms follow, are a call each, and others `steps_per_call`.
    """
    stepping = STEPPINGS[integrator]
    one_by_one = stepping.relaxed or terms_after_steps > 0
    passes: float = len(FB_RK32) if stepping.forward_backward else RK4_STAGES
    if stepping.forward_backward:
        passes += 1.0 if one_by_one else 1.0 / steps_per_call
    # The method asks whether the state is sound; relaxation adds up energy; after either it is asked again.
    reductions = 1 + int(stepping.relaxed) + int(one_by_one)
    return StepPattern(passes + terms_after_steps, reductions)


@dataclass(frozen=True)
class StepTime:
    """Seconds of a step on the slowest process, by cause.

    `compute` is that of a process with an equal share of the cells and nothing else to do. `imbalance` comes from its
    larger share, `halo` from computing cells of others, `overhead` from calls and packing, `latency` from messages,
    `volume` from bytes on their way, `reductions` from agreeing with all others.
    """

    compute: float
    imbalance: float
    halo: float
    overhead: float
    latency: float
    volume: float
    reductions: float

    @property
    def total(self) -> float:
        """Seconds of the step."""
        return sum(getattr(self, field.name) for field in fields(self))

    @property
    def efficiency(self) -> float:
        """Share of the time in which processes do what a single one would: strong and weak efficiency."""
        return self.compute / self.total


def step_time(counts: ExchangeCounts, pattern: StepPattern, machine: Machine, network: Network) -> StepTime:
    """The time of a step on the parts that `counts` describe."""
    share = float(counts.own_cells.mean())
    passes = pattern.passes if counts.n_parts > 1 else 0.0  # a process alone exchanges nothing
    sent = BYTES * np.maximum(counts.values_sent, counts.values_received)
    overhead = passes * (machine.seconds_per_pass + machine.seconds_per_byte * sent)
    latency = passes * network.latency * counts.neighbours
    volume = passes / network.bandwidth * sent
    cells = counts.own_cells + counts.halo_cells_computed
    slowest = int(np.argmax(machine.seconds_per_cell * cells + overhead + latency + volume))
    return StepTime(
        compute=machine.seconds_per_cell * share,
        imbalance=machine.seconds_per_cell * (float(counts.own_cells[slowest]) - share),
        halo=machine.seconds_per_cell * float(counts.halo_cells_computed[slowest]),
        overhead=float(overhead[slowest]),
        latency=float(latency[slowest]),
        volume=float(volume[slowest]),
        reductions=network.latency * pattern.reductions * rounds_of_reduction(counts.n_parts),
    )


def rounds_of_reduction(processes: int) -> int:
    """Messages one after another in a sum over all processes, each of which exchanges with one other in a round.

    Those beyond a power of two give their values to another before, and get the result after.
    """
    doublings = processes.bit_length() - 1
    return doublings if processes == 1 << doublings else doublings + 2


def resized(counts: ExchangeCounts, like: ExchangeCounts) -> ExchangeCounts:
    """Parts in the number and with the neighbours and the spread of `counts`, whose mean sizes are those of `like`.

    So the sizes of many large parts follow from those of many small ones and of a few large ones. What no small part
    has is taken to be the same in all large ones.
    """

    def rescaled(values: Numbers, means: Numbers) -> Array:
        if not values.any():
            return np.full(len(values), means.mean())
        return np.asarray(values * (means.mean() / values.mean()), dtype=np.float64)

    return ExchangeCounts(
        own_cells=rescaled(counts.own_cells, like.own_cells),
        halo_cells=rescaled(counts.halo_cells, like.halo_cells),
        halo_cells_computed=rescaled(counts.halo_cells_computed, like.halo_cells_computed),
        neighbours=counts.neighbours,
        values_sent=rescaled(counts.values_sent, like.values_sent),
        values_received=rescaled(counts.values_received, like.values_received),
    )
