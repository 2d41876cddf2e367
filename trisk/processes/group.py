"""Processes of one command, from the same command line to the same end. Imports mpi4py, so only under mpiexec."""

import os
import sys
import time

from mpi4py import MPI

from trisk.processes.launch import Launch

SECONDS_TO_MEET = 5.0
"""A process that failed waits so long for the others, which end with it if they know of the error."""

SECONDS_BETWEEN_LOOKS = 0.001

SECONDS_TO_BE_HEARD = 0.5
"""What was said just before all are aborted reaches mpiexec within that time."""

THREADS = "NUMBA_NUM_THREADS"


class Group:
    """The processes that were started together; all of them make this object first of all."""

    def __init__(self) -> None:
        self._comm = MPI.COMM_WORLD.Dup()

    @property
    def launch(self) -> Launch:
        """The number of this process, and that of all."""
        return Launch(self._comm.rank, self._comm.size)

    def has_one_command_line(self) -> bool:
        """Whether all processes were started with the same arguments."""
        return len({tuple(each) for each in self._comm.allgather(sys.argv[1:])}) == 1

    def share_processors(self) -> None:
        """Let every process take its share of the processors of its machine, unless the user says how many threads.

        Must come before numba is imported.
        """
        beside = self._comm.Split_type(MPI.COMM_TYPE_SHARED)
        mine = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set(range(os.cpu_count() or 1))
        of_all = set().union(*beside.allgather(mine))
        os.environ.setdefault(THREADS, str(min(len(mine), max(1, len(of_all) // beside.size))))

    def end(self, code: int, said: str) -> tuple[int, str]:
        """Wait for the others; exit code and words of the process of the lowest number that failed, the same for all.

        A process that failed with an error of which the others do not know ends them all, and says why. `said` is what
        it has not said aloud.
        """
        arrival = self._comm.Ibarrier()
        begin = time.monotonic()
        while not arrival.Test():
            if code and time.monotonic() - begin > SECONDS_TO_MEET:
                print(said.strip(), file=sys.__stderr__, flush=True)
                time.sleep(SECONDS_TO_BE_HEARD)
                MPI.COMM_WORLD.Abort(code)
            time.sleep(SECONDS_BETWEEN_LOOKS)
        endings = self._comm.allgather((code, said))
        code, said = next((each for each in endings if each[0]), (code, said))
        return code, said.strip()
