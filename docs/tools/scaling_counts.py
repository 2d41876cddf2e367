"""Real divisions of large meshes, counted, for docs/scaling.md; what has been counted is kept in a folder."""

from dataclasses import fields
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from mesh.arrays import Array, Index
from mesh.generation.scvt import generate_scvt
from mesh.mesh_request import MeshRequest
from mesh.partition.cell_graph import CellGraph, graph_of_triangles
from mesh.partition.curve import blocks_along_curve
from mesh.partition.partition import Partition, partition_graph
from mesh.triangulation.ordering import hilbert_keys
from swe.configuration import Options
from swe.parallel.exchange_counts import ExchangeCounts, count_exchanges
from swe.run.composition import rings_needed

Division = Literal["METIS", "curve"]
DIVISIONS: tuple[Division, ...] = get_args(Division)

RINGS = rings_needed(Options())
"""Rings of halo of the default run."""

MORE_RINGS = rings_needed(Options(scheme="consistent"))
"""The most rings of any run: the consistent scheme, terms that change vorticity, and dissipation."""


class Counted:
    """Counts of meshes by numbers of cells and of parts; each is made once and kept in `folder`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._mesh: tuple[int, Array, CellGraph, Index] | None = None

    def counts(self, cells: int, parts: int, division: Division, rings: int = RINGS) -> ExchangeCounts:
        """The counts of a uniform mesh of `cells` cells, in so many parts with so many rings of halo."""
        path = self._folder / f"counts-{cells}-{parts}-{division}-{rings}.npz"
        if not path.exists():
            graph, edges = self._graph(cells)
            found = count_exchanges(graph, edges, self._divided(cells, parts, division), rings)
            np.savez(path, **{field.name: getattr(found, field.name) for field in fields(found)})
        with np.load(path) as stored:
            return ExchangeCounts(**stored)

    def _divided(self, cells: int, parts: int, division: Division) -> Partition:
        """The blocks; those of METIS are kept, as it takes the longest."""
        if division == "curve":
            _, points, _, edges = self._points_and_graph(cells)
            return Partition(blocks_along_curve(hilbert_keys(points), (edges,), parts), parts)
        path = self._folder / f"blocks-{cells}-{parts}.npy"
        if not path.exists():
            np.save(path, partition_graph(self._graph(cells)[0], parts).block_of_cell)
        return Partition(np.load(path), parts)

    def _graph(self, cells: int) -> tuple[CellGraph, Index]:
        _, _, graph, edges = self._points_and_graph(cells)
        return graph, edges

    def _points_and_graph(self, cells: int) -> tuple[int, Array, CellGraph, Index]:
        """The generators and the graph of the mesh that `trisk mesh --cells` makes, without its metrics."""
        if self._mesh is None or self._mesh[0] != cells:
            path = self._folder / f"triangles-{cells}.npz"
            if not path.exists():
                result = generate_scvt(MeshRequest(cells))
                np.savez(path, points=result.points, triangles=result.triangles)
            with np.load(path) as stored:
                graph = graph_of_triangles(cells, stored["triangles"])
                self._mesh = cells, stored["points"], graph, graph.edges
        return self._mesh
