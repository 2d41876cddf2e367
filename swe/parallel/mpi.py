"""The processes of a run under MPI, each of which holds one part of the mesh. Nothing else imports mpi4py."""

from collections.abc import Callable

import numpy as np
from mpi4py import MPI

from mesh.arrays import Array, Index
from mesh.parts.mesh_part import MeshPart
from mesh.triangulation.ordering import inverse_order
from swe.errors import InputError
from swe.parallel.exact_sum import exact_words, rounded
from swe.parallel.exchange_plan import Messages, Packing, packing_of, plan_exchange, starts_of
from swe.parallel.processes import Own
from swe.state import State


class MpiProcesses:
    """See `swe.parallel.processes.Processes`; the process of rank r holds the part of block r.

    Requests to send and receive are made once, here, and started in each exchange. All processes make this object at
    the same time, with parts that are cut from the same mesh with the same blocks and rings. Raises `InputError` if
    the block of `part` is not the rank.

    Attributes
    ----------
    part
        The part of the mesh that this process holds.
    plan
        What it sends and receives in an exchange: `swe.parallel.exchange_plan.ExchangePlan`.
    """

    def __init__(self, part: MeshPart, communicator: MPI.Intracomm = MPI.COMM_WORLD) -> None:
        self._comm = communicator.Dup()
        if part.block != self._comm.rank:
            raise InputError(f"process {self._comm.rank} holds block {part.block}; it must hold that of its own number")
        self.part = part
        self.own = Own(part.own_cells, part.own_edges, part.own_vertices)
        self.plan = plan_exchange(part, self._comm.size, self._comm.alltoall)
        self._out, self._sends = _requests(self.plan.sent, self._comm.Send_init)
        self._in, self._receives = _requests(self.plan.received, self._comm.Recv_init)
        self.exchange = self.exchange_in(None, None)

    @property
    def alone(self) -> bool:
        """Whether there is only one process."""
        return self._comm.size == 1

    def exact_sums(self, rows: Array) -> list[float]:
        """See `Processes`; the words of all processes are added, and rounded once."""
        words, finite = exact_words(rows)
        counts = np.column_stack([words, 1 - finite])
        self._comm.Allreduce(MPI.IN_PLACE, counts)
        if counts[:, -1].any():
            plain = self.sums(rows.sum(axis=1))
            return [float(plain[k]) if row[-1] else rounded(row[:-1]) for k, row in enumerate(counts)]
        return [rounded(row[:-1]) for row in counts]

    def sums(self, values: Array) -> Array:
        """See `Processes`."""
        total = np.empty_like(values)
        self._comm.Allreduce(np.ascontiguousarray(values), total)
        return total

    def largest(self, values: Array) -> Array:
        """See `Processes`; what MPI makes of NaN is not defined, so they are told of apart."""
        wrong = np.isnan(values)
        found = np.stack([np.where(wrong, -np.inf, values), wrong])
        self._comm.Allreduce(MPI.IN_PLACE, found, MPI.MAX)
        return np.where(found[1] > 0.0, np.nan, found[0])

    def exchange_in(self, cell_order: Index | None, edge_order: Index | None) -> Callable[[State], None]:
        """See `Processes`."""
        ranks = [None if order is None else inverse_order(order) for order in (cell_order, edge_order)]
        packed, unpacked = packing_of(self.plan.sent, *ranks), packing_of(self.plan.received, *ranks)
        return lambda state: self._exchange(state.thickness, state.normal_velocity, packed, unpacked)

    def _exchange(self, h: Array, u: Array, packed: Packing, unpacked: Packing) -> None:
        MPI.Prequest.Startall(self._receives)
        packed.pack(h, u, self._out)
        MPI.Prequest.Startall(self._sends)
        MPI.Request.Waitall([*self._receives, *self._sends])
        unpacked.unpack(self._in, h, u)


def _requests(messages: Messages, request: Callable[[Array, int], MPI.Prequest]) -> tuple[Array, list[MPI.Prequest]]:
    """A buffer for all `messages`, and the persistent `request` of each for its place in it."""
    starts = starts_of(messages)
    buffer = np.zeros(starts[-1])
    pairs = zip(messages, starts[:-1], starts[1:], strict=True)
    return buffer, [request(buffer[start:end], message.block) for message, start, end in pairs]
