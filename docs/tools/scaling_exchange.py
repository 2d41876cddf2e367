"""What an exchange costs between the processes of one machine, for docs/scaling.md.

mpiexec -n 2 python -m mpi4py docs/tools/scaling_exchange.py RESULTS.json CELLS ...

Each process holds one run of cells along the curve of test case 5 with its halo. Turns alternate: exchanges alone, one
after another; steps of RK4 with their exchanges; and steps of the same own cells without any.
"""

import argparse
import json
import os
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")  # a core for each process

import numpy as np
from mpi4py import MPI

from cases import Williamson5
from mesh import scvt_mesh
from mesh.arrays import Array
from mesh.partition.curve import blocks_along_curve
from mesh.parts.mesh_part import cut_part
from mesh.triangulation.ordering import hilbert_keys
from swe import ShallowWaterModel, Simulation
from swe.configuration import Options
from swe.parallel.mpi import MpiProcesses
from swe.parallel.processes import OneProcess, Own
from swe.run.composition import rings_needed
from swe.tiles.fused import FusedRungeKutta

ROUNDS = 200
"""Turns of each kind, one step or exchange each."""

QUIET = 10.0
"""Percentile of the turns beside the median: what a turn takes where neither process is held up by other programs."""


@dataclass(frozen=True)
class Measured:
    """Seconds of the slower process, the `QUIET` percentile over turns and the median; messages and bytes of process 0.

    `exchange` is one exchange, `step` a step with its exchanges, `alone` one of the same cells without.
    """

    cells: int
    part_cells: int
    messages: int
    bytes_sent: int
    exchange: tuple[float, float]
    step: tuple[float, float]
    alone: tuple[float, float]


class Silent(OneProcess):
    """A process that computes no more than what it owns, and neither sends nor receives."""

    def __init__(self, own: Own) -> None:
        self.own = own


def measure(comm: MPI.Intracomm, cells: int) -> Measured:
    """The measurement on a mesh of `cells` cells, the same on all processes."""
    mesh = scvt_mesh(cells)
    blocks = blocks_along_curve(hilbert_keys(mesh.cell_points), (mesh.cells_on_edge,), comm.size)
    part = cut_part(mesh, blocks, comm.rank, rings_needed(Options()))
    processes = MpiProcesses(part)
    simulation = Simulation(part.mesh, Williamson5(), processes=processes)
    model, time_step = simulation.model, simulation.configuration.time_step
    silent = Silent(processes.own)
    alone = FusedRungeKutta(
        ShallowWaterModel(model.mesh, model.topography, model.coriolis, model.gravity, processes=silent)
    )
    start = simulation.state.copy()

    together = simulation.method
    assert isinstance(together, FusedRungeKutta)
    turns = alternating(
        comm,
        [
            lambda: processes.exchange(start),
            lambda: together.advance(simulation.state, time_step),
            lambda: alone.advance(start, time_step),
        ],
    )
    tenth, median = np.percentile(turns, [QUIET, 50.0], axis=0).tolist()
    return Measured(
        cells,
        part.mesh.n_cells,
        processes.plan.messages,
        processes.plan.bytes_per_exchange,
        *zip(tenth, median, strict=True),
    )


def alternating(comm: MPI.Intracomm, works: list[Callable[[], object]]) -> Array:
    """Seconds (ROUNDS, n) that each of the works takes the slower process; they are done in turns."""
    turns = np.empty((ROUNDS, len(works)))
    for turn in turns:
        for number, work in enumerate(works):
            work()  # brings what it needs into the caches
            comm.Barrier()
            begin = time.perf_counter()
            work()
            turn[number] = time.perf_counter() - begin
    comm.Allreduce(MPI.IN_PLACE, turns, MPI.MAX)
    return turns


def main() -> None:
    """Measure on each mesh, and write the results on process 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    parser.add_argument("cells", type=int, nargs="+")
    arguments = parser.parse_args()
    found = [asdict(measure(MPI.COMM_WORLD, cells)) for cells in arguments.cells]
    if MPI.COMM_WORLD.rank == 0:
        arguments.results.write_text(json.dumps(found))


if __name__ == "__main__":
    main()
