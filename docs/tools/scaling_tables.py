"""What the model of a step predicts for real divisions, as tables in Markdown for docs/scaling.md."""

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace

import numpy as np

from scaling_counts import DIVISIONS, MORE_RINGS, RINGS, Counted, Division
from swe.parallel.exchange_counts import ExchangeCounts
from swe.parallel.step_model import Machine, Network, StepPattern, StepTime, resized, step_pattern, step_time
from swe.run.simulation import CELL_STEPS_PER_CALL

CELLS = (655362, 2621442)
PARTS = (2, 4, 16, 64, 256, 1024, 10000)

WEAK_CELLS = 65536
COUNTED = {2: 163842, 10: 655362, 40: 2621442}
"""Meshes that have about as many cells a part as weak scaling asks for, by numbers of parts."""

SPREAD_OF, SIZES_OF = 2621442, 40
"""Of more parts than that, neighbours and spread are those of this mesh in so many parts, sizes those of 40 parts."""

RESIZED = (64, 256)
"""Numbers of parts for which resizing is compared with what is counted."""

MANY = 10000

MACHINE = Machine(seconds_per_cell=157e-9, seconds_per_pass=50e-6, seconds_per_byte=0.4e-9)
"""One thread. A cell is from docs/performance.md, of 10242 on one thread of a quiet machine; a pass is what two
processes measure (`scaling_page.exchange_lines`); a byte is twice its packing and unpacking in warm caches."""

NETWORK = Network()

RK4 = step_pattern("rk4")
CONSISTENT = 1.87 + 0.27
"""Cost of a step of the consistent scheme with anticipation and dissipation for that of the default one
(docs/performance.md)."""

FBRK3 = 0.91
"""The same of fbrk3."""


@dataclass(frozen=True)
class Setting:
    """What the model is asked: how a step goes, on what machine and network, and how cells are divided.

    `own_cells_only` computes nothing in the halo, as where a part's own cells come first in its numbering;
    `equal_blocks` gives each part as many cells as any other.
    """

    machine: Machine = MACHINE
    network: Network = NETWORK
    pattern: StepPattern = RK4
    rings: int = RINGS
    division: Division = "curve"
    own_cells_only: bool = False
    equal_blocks: bool = False

    def time(self, counts: ExchangeCounts) -> StepTime:
        """The time of a step on parts, which have the rings of this setting."""
        if self.own_cells_only:
            counts = replace(counts, halo_cells_computed=np.zeros_like(counts.halo_cells_computed))
        if self.equal_blocks:
            counts = replace(counts, own_cells=np.full(counts.n_parts, counts.own_cells.mean()))
        return step_time(counts, self.pattern, self.machine, self.network)


AS_BUILT = Setting()
"""The default of `trisk run`: runs along the curve."""

METIS = Setting(division="METIS")
"""The same program on METIS blocks."""

METIS_OWN_FIRST = replace(METIS, own_cells_only=True)
"""As it would be if a part numbered its own cells first, so that its tiles could leave out the others."""

MENDED = replace(AS_BUILT, machine=replace(MACHINE, seconds_per_pass=0.0))
"""As it would be without calls from Python in a step."""

STEPS_PER_CALL = max(1, CELL_STEPS_PER_CALL // WEAK_CELLS)

SETTINGS: dict[str, Setting] = {
    "as built": AS_BUILT,
    "METIS blocks": METIS,
    "METIS, own cells numbered first": METIS_OWN_FIRST,
    "METIS, own cells numbered first, blocks of equal size": replace(METIS_OWN_FIRST, equal_blocks=True),
    "no calls from Python in a step": MENDED,
    "rrk4": replace(AS_BUILT, pattern=step_pattern("rrk4")),
    f"fbrk3, {STEPS_PER_CALL} steps a call": replace(
        AS_BUILT,
        pattern=step_pattern("fbrk3", steps_per_call=STEPS_PER_CALL),
        machine=replace(MACHINE, seconds_per_cell=FBRK3 * MACHINE.seconds_per_cell),
    ),
    "consistent, anticipation and dissipation": Setting(
        pattern=step_pattern("rk4", terms_after_steps=1),
        machine=replace(MACHINE, seconds_per_cell=CONSISTENT * MACHINE.seconds_per_cell),
        rings=MORE_RINGS,
    ),
    "100 us for each pass": replace(AS_BUILT, machine=replace(MACHINE, seconds_per_pass=100e-6)),
    "latency 10 us": replace(AS_BUILT, network=Network(latency=10e-6)),
    "64 processes share 12 GB/s": replace(AS_BUILT, network=Network(bandwidth=12e9 / 64)),
    "57 ns a cell": replace(AS_BUILT, machine=replace(MACHINE, seconds_per_cell=57e-9)),
}


def weak_counts(counted: Counted, parts: int, division: Division, rings: int = RINGS) -> ExchangeCounts:
    """Parts of about `WEAK_CELLS` cells: counted where a mesh has them, else resized from smaller ones."""
    if parts in COUNTED:
        return counted.counts(COUNTED[parts], parts, division, rings)
    like = counted.counts(COUNTED[SIZES_OF], SIZES_OF, division, rings)
    return resized(counted.counts(SPREAD_OF, parts, division, rings), like)


def weak_parts() -> list[int]:
    """Numbers of processes of weak scaling."""
    return [*COUNTED, *(parts for parts in PARTS if parts > SIZES_OF)]


def table(heading: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    """A table in Markdown."""
    names = list(heading)
    return [_line(names), "|---" * len(names) + "|", *map(_line, rows)]


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def division_lines(counted: Counted) -> list[str]:
    """Both divisions of both meshes side by side: METIS, then the curve."""
    rows = []
    for cells in CELLS:
        for parts in PARTS:
            both = [counted.counts(cells, parts, division) for division in DIVISIONS]
            first, second = (float(counts.bytes_sent.mean()) for counts in both)
            rows.append(
                [
                    f"{cells}",
                    f"{parts}",
                    _pair(f"{c.bytes_sent.mean() / 1e3:.1f}" for c in both),
                    _pair(f"{c.bytes_sent.max() / 1e3:.1f}" for c in both),
                    f"{second / first - 1.0:+.0%}",
                    _pair(f"{c.neighbours.mean():.1f}" for c in both),
                    _pair(f"{c.neighbours.max()}" for c in both),
                    _pair(f"{c.own_cells.max() / c.own_cells.mean():.3f}" for c in both),
                    _pair(f"{(c.own_cells + c.halo_cells_computed).max() / c.own_cells.mean():.3f}" for c in both),
                ]
            )
    heading = ["cells", "parts", "kB sent: mean", "most", "curve / METIS, mean", "messages: mean", "most"]
    return table([*heading, "own cells: most / mean", "computed: most / mean"], rows)


def _pair(texts: Iterable[str]) -> str:
    return ", ".join(texts)


def weak_lines(counted: Counted) -> list[str]:
    """Where the time of a step goes in weak scaling, as parts of `compute`."""
    rows = []
    for parts in weak_parts():
        for division in DIVISIONS:
            counts = weak_counts(counted, parts, division)
            source = "counted" if parts in COUNTED else "resized"
            cells = f"{counts.own_cells.mean():.0f}, {source}"
            rows.append([f"{parts}", cells, division, *_shares(AS_BUILT.time(counts))])
    return table(["processes", "cells each", "division", *_CAUSES, "efficiency"], rows)


def setting_lines(counted: Counted) -> list[str]:
    """The same on the most processes, in all settings."""
    rows = [
        [name, *_shares(setting.time(weak_counts(counted, MANY, setting.division, setting.rings)))]
        for name, setting in SETTINGS.items()
    ]
    return table(["setting", *_CAUSES, "efficiency"], rows)


_CAUSES = [field.name for field in fields(StepTime) if field.name != "compute"]


def _shares(found: StepTime) -> list[str]:
    shares = (round(getattr(found, cause) / found.compute, 3) + 0.0 for cause in _CAUSES)  # no negative zero
    return [*(f"{share:.1%}" for share in shares), f"{found.efficiency:.3f}"]


def cause_lines(counted: Counted) -> list[str]:
    """The same in strong scaling of the larger mesh."""
    rows = []
    for parts in PARTS:
        counts = counted.counts(CELLS[-1], parts, AS_BUILT.division)
        rows.append([f"{parts}", f"{counts.own_cells.mean():.0f}", *_shares(AS_BUILT.time(counts))])
    return table(["processes", "cells each", *_CAUSES, "efficiency"], rows)


def strong_lines(counted: Counted) -> list[str]:
    """Efficiency and microseconds of a step in strong scaling: the curve as built and mended, and METIS."""
    rows = []
    for cells in CELLS:
        for parts in PARTS:
            metis, curve = (counted.counts(cells, parts, division) for division in DIVISIONS)
            found = [AS_BUILT.time(curve), METIS.time(metis), MENDED.time(curve)]
            rows.append(
                [
                    f"{cells}",
                    f"{parts}",
                    f"{cells / parts:.0f}",
                    *(f"{time.efficiency:.3f}" for time in found),
                    *(f"{1e6 * time.total:.0f}" for time in (found[0], found[2])),
                ]
            )
    heading = ["cells", "processes", "cells each", "curve", "METIS", "curve, mended", "step, us", "mended, us"]
    return table(heading, rows)


def resizing_lines(counted: Counted) -> list[str]:
    """What resizing gives where the parts can be counted as well: those of the larger mesh, from the smaller one's.

    Spread and neighbours are those of the smaller mesh in as many parts, sizes those of parts of it as large.
    """
    small, large = CELLS
    rows = []
    for division in DIVISIONS:
        for parts in RESIZED:
            like = counted.counts(small, parts // 4, division)  # parts of the same mean size
            found = resized(counted.counts(small, parts, division), like)
            real = counted.counts(large, parts, division)
            rows.append(
                [
                    division,
                    f"{parts}",
                    _pair(f"{c.own_cells.max() / c.own_cells.mean():.3f}" for c in (found, real)),
                    _pair(f"{c.halo_cells.mean():.0f}" for c in (found, real)),
                    _pair(f"{c.halo_cells.max():.0f}" for c in (found, real)),
                    _pair(f"{c.bytes_sent.max() / 1e3:.1f}" for c in (found, real)),
                    _pair(f"{AS_BUILT.time(c).efficiency:.3f}" for c in (found, real)),
                ]
            )
    heading = ["division", "parts", "own cells: most / mean", "halo cells: mean", "most", "kB sent: most", "efficiency"]
    return table(heading, rows)
