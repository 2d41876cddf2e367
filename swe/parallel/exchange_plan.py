"""Who sends what to whom between the stages of a step, and how values are packed into messages.

A part of a mesh reads the thickness of its halo cells and the velocity at its halo edges from their owners, one message
from each. The same lists, sent to the owners, say what these have to send.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np

from mesh.arrays import Array, Index
from mesh.parts.mesh_part import MeshPart

BYTES = 8
"""Bytes of a value."""

compiled = numba.njit(cache=True)


@dataclass(frozen=True, eq=False)
class Message:
    """The cells and edges, by their numbers in a part, whose values go to or come from another `block`."""

    block: int
    cells: Index
    edges: Index

    @property
    def values(self) -> int:
        """Number of values."""
        return len(self.cells) + len(self.edges)


Messages = tuple[Message, ...]


def bytes_of(messages: Messages) -> int:
    """Bytes in all of the `messages`."""
    return BYTES * sum(message.values for message in messages)


def messages_read(part: MeshPart) -> Messages:
    """What `part` reads from each of its neighbours, in the order of their blocks."""
    cells, edges = part.halo_cells, part.halo_edges
    cell_owner, edge_owner = part.cell_owner[cells], part.edge_owner[edges]
    return tuple(
        Message(int(block), cells[cell_owner == block], edges[edge_owner == block])
        for block in np.union1d(cell_owner, edge_owner)
    )


@dataclass(frozen=True, eq=False)
class ExchangePlan:
    """What a part sends and receives in an exchange."""

    sent: Messages
    received: Messages

    @property
    def messages(self) -> int:
        """Number of messages that it sends in an exchange."""
        return len(self.sent)

    @property
    def bytes_per_exchange(self) -> int:
        """Bytes that it sends in an exchange."""
        return bytes_of(self.sent)


Swap = Callable[[list[tuple[Index, Index]]], list[tuple[Index, Index]]]
"""Gives every process one item of a list, and returns what they gave."""


def plan_exchange(part: MeshPart, processes: int, swap: Swap) -> ExchangePlan:
    """The exchanges of `part` with those of other `processes`, each of which holds the block of its number."""
    received = messages_read(part)
    nothing: Index = np.zeros(0, np.int64)
    wanted = [(nothing, nothing)] * processes
    for message in received:
        wanted[message.block] = part.cells[message.cells], part.edges[message.edges]
    sent = tuple(
        Message(block, np.searchsorted(part.cells, cells), np.searchsorted(part.edges, edges))
        for block, (cells, edges) in enumerate(swap(wanted))
        if len(cells) + len(edges)
    )
    return ExchangePlan(sent, received)


@dataclass(frozen=True, eq=False)
class Packing:
    """Where the values of cells and edges are in the arrays of a state, and where in the buffer of all messages.

    The buffer holds one message after another, each with its cells before its edges.
    """

    cells: Index
    cells_at: Index
    edges: Index
    edges_at: Index

    def pack(self, h: Array, u: Array, buffer: Array) -> None:
        """Copy values of a state into the buffer."""
        _gather(h, self.cells, self.cells_at, buffer)
        _gather(u, self.edges, self.edges_at, buffer)

    def unpack(self, buffer: Array, h: Array, u: Array) -> None:
        """Copy values from the buffer into a state."""
        _gather(buffer, self.cells_at, self.cells, h)
        _gather(buffer, self.edges_at, self.edges, u)


def packing_of(messages: Messages, cell_rank: Index | None = None, edge_rank: Index | None = None) -> Packing:
    """The packing of `messages` for states in which the entities of the part have these ranks (None: their numbers)."""
    starts = starts_of(messages)
    nothing: Index = np.zeros(0, np.int64)
    cells, cells_at, edges, edges_at = ([nothing] for _ in range(4))
    for message, start in zip(messages, starts, strict=False):
        middle = start + len(message.cells)
        cells.append(message.cells if cell_rank is None else cell_rank[message.cells])
        cells_at.append(np.arange(start, middle))
        edges.append(message.edges if edge_rank is None else edge_rank[message.edges])
        edges_at.append(np.arange(middle, start + message.values))
    return Packing(*(np.concatenate(each).astype(np.int64) for each in (cells, cells_at, edges, edges_at)))


def starts_of(messages: Messages) -> list[int]:
    """Where each message starts in the buffer, and where the last one ends."""
    return [0, *np.cumsum([message.values for message in messages], dtype=int).tolist()]


@compiled
def _gather(values: Array, places: Index, targets: Index, result: Array) -> None:
    """Copy `values` from `places` to `targets` of `result`."""
    for k in range(places.size):
        result[targets[k]] = values[places[k]]
