"""A communicator that counts what goes through it, for `swe.parallel.mpi`."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

from mpi4py import MPI


class Traffic:
    """Counts messages sent and their bytes as requests are started, and reductions."""

    def __init__(self, communicator: MPI.Intracomm) -> None:
        self._communicator = communicator
        self._bytes_of_send: dict[int, int] = {}
        self.messages = self.bytes = self.reductions = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._communicator, name)

    def Dup(self) -> "Traffic":  # noqa: N802
        return self

    def Send_init(self, buffer: Any, block: int) -> MPI.Prequest:  # noqa: N802
        request = self._communicator.Send_init(buffer, block)
        self._bytes_of_send[id(request)] = buffer.nbytes
        return request

    def Allreduce(self, *arguments: Any) -> None:  # noqa: N802
        self.reductions += 1
        self._communicator.Allreduce(*arguments)

    @contextmanager
    def counted(self) -> Iterator[None]:
        """Within the context, requests that `swe.parallel.mpi` starts are counted."""

        def start(requests: Sequence[MPI.Prequest]) -> None:
            sent = [self._bytes_of_send[id(request)] for request in requests if id(request) in self._bytes_of_send]
            self.messages += len(sent)
            self.bytes += sum(sent)
            MPI.Prequest.Startall(requests)

        names = {name: getattr(MPI, name) for name in ("IN_PLACE", "MAX", "Request")}
        counting = SimpleNamespace(**names, Prequest=SimpleNamespace(Startall=start))
        with patch("swe.parallel.mpi.MPI", counting):
            yield
