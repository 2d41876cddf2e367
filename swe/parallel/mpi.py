"""The processes of a run under MPI, each of which holds one part of the mesh."""

from collections.abc import Callable
from typing import get_args

import numpy as np
from mpi4py import MPI

from mesh.arrays import Array, Index
from mesh.files.whole_mesh import WholeMesh
from mesh.parts.mesh_part import MeshPart
from mesh.triangulation.ordering import inverse_order
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError
from swe.parallel import agreement
from swe.parallel.exact_sum import exact_words, rounded
from swe.parallel.exchange_plan import Messages, Packing, packing_of, plan_exchange, starts_of
from swe.parallel.processes import Own, Place, Result
from swe.state import State

NOTHING: Array = np.empty(0)
"""What processes other than the first have of a whole field."""

PLACES: tuple[Place, ...] = get_args(Place)


class MpiProcesses:
    """See `swe.parallel.processes.Processes`; the process of rank r holds the part of block r.

    Requests to send and receive are made once, here, and started in each exchange. All processes make this object at
    the same time, with parts that are cut from the same mesh with the same blocks and rings. Raises `InputError` if
    the block of `part` is not the rank. A run that is written needs `whole`, the mesh of all of them in metres.

    Attributes
    ----------
    part
        The part of the mesh that this process holds.
    plan
        What it sends and receives in an exchange: `swe.parallel.exchange_plan.ExchangePlan`.
    """

    def __init__(
        self, part: MeshPart, whole: WholeMesh | None = None, communicator: MPI.Intracomm = MPI.COMM_WORLD
    ) -> None:
        self._comm = communicator.Dup()
        self._whole = whole
        if part.block != self._comm.rank:
            raise InputError(f"process {self._comm.rank} holds block {part.block}; it must hold that of its own number")
        self.part = part
        self.own = Own(part.own_cells, part.own_edges, part.own_vertices)
        self._owned = {place: self._numbers_of_owned(place) for place in PLACES}
        self.plan = plan_exchange(part, self._comm.size, self._comm.alltoall)
        self._out, self._sends = _requests(self.plan.sent, self._comm.Send_init)
        self._in, self._receives = _requests(self.plan.received, self._comm.Recv_init)
        self.exchange = self.exchange_in(None, None)

    @property
    def count(self) -> int:
        """See `Processes`."""
        return self._comm.size

    @property
    def alone(self) -> bool:
        """See `Processes`."""
        return self.count == 1

    @property
    def first(self) -> bool:
        """See `Processes`; that of rank 0."""
        return self._comm.rank == 0

    def number(self, place: Place, local: int) -> int:
        """See `Processes`."""
        return int(getattr(self.part, place)[local])

    def whole_mesh(self, _: VoronoiMesh) -> WholeMesh:
        """See `Processes`; raises `InputError` if it was not given."""
        if self._whole is None:
            raise InputError("the processes do not know the whole mesh; give MpiProcesses the file that it is in")
        return self._whole

    def on_first(self, action: Callable[[], Result]) -> Result:
        """See `Processes`."""
        return agreement.on_first(self._comm, action)

    def together(self, action: Callable[[], Result]) -> Result:
        """See `Processes`."""
        return agreement.together(self._comm, action)

    def gathered(self, place: Place, values: Array) -> Array:
        """See `Processes`."""
        mine = np.ascontiguousarray(values[getattr(self.own, place)])
        if not self.first:
            self._comm.Gatherv(mine, None)
            return NOTHING
        numbers, counts = self._owned[place]
        pieces = np.empty(len(numbers))
        self._comm.Gatherv(mine, (pieces, counts))
        whole = np.empty_like(pieces)
        whole[numbers] = pieces
        return whole

    def scattered(self, place: Place, values: Array) -> Array:
        """See `Processes`; each of the others says which values it wants, and gets them."""
        numbers: Index = getattr(self.part, place)
        if not self.first:
            self._comm.send(numbers, 0)
            mine = np.empty(len(numbers))
            self._comm.Recv(mine, 0)
            return mine
        for rank in range(1, self._comm.size):
            wanted = self._comm.recv(source=rank)
            self._comm.Send(values[wanted], rank)
        return values[numbers]

    def _numbers_of_owned(self, place: Place) -> tuple[Index, list[int]]:
        """On the first process the numbers of what each process owns, one after another, and their counts."""
        mine = getattr(self.part, place)[getattr(self.own, place)].astype(np.int32)
        counts = self._comm.gather(len(mine))
        if counts is None:
            self._comm.Gatherv(mine, None)
            return np.empty(0, np.int32), []
        numbers = np.empty(sum(counts), np.int32)
        self._comm.Gatherv(mine, (numbers, counts))
        return numbers, counts

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
