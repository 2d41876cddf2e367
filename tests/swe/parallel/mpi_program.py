"""What `mpiexec` runs for `test_mpi`: jobs from a file, whose results process 0 writes to another.

Called with the path of a pickled mesh, that of a JSON list of jobs, and that of the results. A job is a run of test
case 5 on the mesh; the process of rank r holds the cells of block r, a run of cells by longitude.
"""

import json
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.arrays import Array
from mesh.parts.mesh_part import MeshPart, cut_part
from swe import Simulation
from swe.configuration import Options
from swe.parallel.mpi import MpiProcesses
from swe.run.composition import rings_needed
from tests.swe.parallel.short_run import TIME_STEP, blocks_by_longitude, fields_of, hash_of, row_of, short_run
from tests.swe.parallel.traffic import Traffic


def gathered(comm: MPI.Intracomm, part: MeshPart, place: str, values: Array) -> Array:
    """The whole field, from what each process owns of it."""
    own = getattr(part, f"own_{place}")
    pieces = comm.allgather((getattr(part, place)[own], values[own]))
    numbers, found = (np.concatenate(each) for each in zip(*pieces, strict=True))
    assert (np.sort(numbers) == np.arange(len(numbers))).all(), "every entity has one owner"
    return found[np.argsort(numbers)]


def run(comm: MPI.Intracomm, mesh: VoronoiMesh, job: dict[str, Any]) -> dict[str, Any]:
    """One run, on parts that lack `less` of the rings that its options need."""
    part = cut_part(
        mesh, blocks_by_longitude(mesh, comm.size), comm.rank, rings_needed(Options(**job["options"])) - job["less"]
    )
    processes = MpiProcesses(part)
    simulation = short_run(part.mesh, job["options"], processes)
    return {
        "fields": {
            name: hash_of(gathered(comm, part, place, values))
            for name, (place, values) in fields_of(simulation).items()
        },
        "row": row_of(simulation),
        "steps": simulation.steps,
        "loops": simulation.loops,
        "sent": comm.allreduce(processes.plan.bytes_per_exchange),
        "messages": comm.allreduce(processes.plan.messages),
        "received": comm.allreduce(8 * sum(message.values for message in processes.plan.received)),
    }


def break_off(comm: MPI.Intracomm, mesh: VoronoiMesh, job: dict[str, Any]) -> dict[str, Any]:
    """Steps taken by each process when a value of the last one turns out unsound."""
    part = cut_part(mesh, blocks_by_longitude(mesh, comm.size), comm.rank, 3)
    simulation = Simulation(
        part.mesh, Williamson5(), time_step=TIME_STEP, processes=MpiProcesses(part), **job["options"]
    )
    if comm.rank == comm.size - 1:
        simulation.state.normal_velocity[part.own_edges[5]] = 1e200
    stepper = simulation.stepper
    _, taken = stepper.advance(simulation.state, 0.0, 86400.0, TIME_STEP, 50)
    return {"taken": comm.allgather(taken), "unsound": comm.allgather(stepper.unsound > 0)}


def count(comm: MPI.Intracomm, mesh: VoronoiMesh, job: dict[str, Any]) -> dict[str, Any]:
    """What each process sends in some steps, in one call of the stepper or in one for each, and how often all agree."""
    part = cut_part(mesh, blocks_by_longitude(mesh, comm.size), comm.rank, rings_needed(Options(**job["options"])))
    traffic = Traffic(comm)
    with traffic.counted():
        processes = MpiProcesses(part, communicator=traffic)
        simulation = Simulation(part.mesh, Williamson5(), time_step=TIME_STEP, processes=processes, **job["options"])
        traffic.messages = traffic.bytes = traffic.reductions = 0
        for _ in range(job["calls"]):
            _, taken = simulation.stepper.advance(simulation.state, 0.0, 1e9, TIME_STEP, job["steps"])
            assert taken == job["steps"]
    return {
        "loops": simulation.loops,
        "messages": comm.allgather(traffic.messages),
        "bytes": comm.allgather(traffic.bytes),
        "reductions": comm.allgather(traffic.reductions),
    }


def collect(comm: MPI.Intracomm, mesh: VoronoiMesh, job: dict[str, Any]) -> dict[str, Any]:
    """Sums and extremes over processes of which each has some of the values."""
    processes = MpiProcesses(cut_part(mesh, blocks_by_longitude(mesh, comm.size), comm.rank, 1))
    random = np.random.default_rng(3)
    rows = random.normal(size=(3, 999)) * 10.0 ** random.integers(-200, 200, (3, 999))
    rows[2, 500] = np.nan
    mine = rows[:, comm.rank :: comm.size]
    wrong = np.array([1.0, np.nan if comm.rank == 1 else 2.0, float(comm.rank)])
    return {
        "exact": processes.exact_sums(mine),
        "sums": processes.sums(np.array([1.0, 2.0**comm.rank])).tolist(),
        "largest": processes.largest(wrong).tolist(),
    }


def main() -> None:
    comm = MPI.COMM_WORLD
    mesh, jobs, results = (Path(argument) for argument in sys.argv[1:])
    whole = pickle.loads(mesh.read_bytes())
    kinds = {"run": run, "break_off": break_off, "collect": collect, "count": count}
    found = [kinds[job["kind"]](comm, whole, job) for job in json.loads(jobs.read_text())]
    if comm.rank == 0:
        results.write_text(json.dumps(found))


if __name__ == "__main__":
    main()
