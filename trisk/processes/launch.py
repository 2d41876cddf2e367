"""Whether mpiexec started the command, and how often: told by the environment, so that mpi4py may be missing."""

import os
from collections.abc import Mapping
from dataclasses import dataclass

NAMES = (("PMI_RANK", "PMI_SIZE"), ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"))
"""Variables in which launchers tell a process its number and how many there are: MPICH and its kin, and Open MPI."""


@dataclass(frozen=True)
class Launch:
    """The number of this process, from 0, and how many were started."""

    rank: int
    size: int

    @property
    def first(self) -> bool:
        """Whether this is the process that speaks for all."""
        return self.rank == 0


def launch_of(environment: Mapping[str, str] = os.environ) -> Launch:
    """What the launcher says; a process on its own where there was none."""
    for rank, size in NAMES:
        if environment.get(rank, "").isdigit() and environment.get(size, "").isdigit():
            return Launch(int(environment[rank]), int(environment[size]))
    return Launch(0, 1)
