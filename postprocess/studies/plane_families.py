"""Families of meshes on planes that a study compares, on the plane of a case."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from cases.base import Case
from cases.plane.base import PlaneCase
from mesh.mesh_request import MeshRequest
from mesh.plane.generation import mesh_on_plane
from mesh.plane.hexagons import FEWEST_COLUMNS, FEWEST_ROWS, ROUNDING, ROW, hexagon_mesh
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.studies.families import Family
from swe.errors import InputError

LEAST_CELLS, LARGEST_CELLS = 12, 1_000_000

PLANE_CELLS = (576, 2304, 9216)
"""Sizes of the meshes of a study unless others are asked for."""

HEXAGONS = "hexagons"

TOLERANCE = 1e-6
"""Residual of Voronoi meshes, mean spacings."""

FARTHEST = 2.0
"""Meshes may have this many times more, or fewer, cells than are asked for."""

LENGTHS = ("x_length", "y_length")
"""Parameters of cases that tell their plane."""


@dataclass(frozen=True)
class StudyPlane:
    """The plane of a study: its lengths along x and y, m, and where it is periodic, see `mesh.plane.hexagons`."""

    lengths: tuple[float, float]
    periodic: str = "xy"

    @property
    def families(self) -> dict[str, Family]:
        """Families by name."""
        x_length, y_length = self.lengths
        plane = f"a plane of {x_length!r} by {y_length!r} m, periodic in {self.periodic}"
        return {
            HEXAGONS: Family(f"regular hexagons of {plane}", self._hexagons),
            "cvt": Family(f"converged Voronoi meshes, from rows of cells, of {plane}", partial(self._voronoi, "rows")),
            "random": Family(f"the same from random points, of {plane}", partial(self._voronoi, "random")),
        }

    def require_cells(self, family: str, cells: int) -> None:
        """Raise `InputError` unless there is a mesh of the family with about so many cells."""
        if not LEAST_CELLS <= cells <= LARGEST_CELLS:
            raise InputError(f"a plane of a study cannot have {cells} cells; give {LEAST_CELLS} to {LARGEST_CELLS}")
        if not all(np.isfinite(length) and length > 0.0 for length in self.lengths):
            x_length, y_length = self.lengths
            raise InputError(f"the plane has the lengths {x_length:g} and {y_length:g} m; give positive, finite ones")
        if family == HEXAGONS:
            self._counts(cells)

    def _voronoi(self, start: str, cells: int) -> VoronoiMesh:
        return mesh_on_plane(
            MeshRequest(cells, plane=self.lengths, periodic=self.periodic, start=start, tolerance=1e-6)
        )

    def _hexagons(self, cells: int) -> VoronoiMesh:
        return hexagon_mesh(self.lengths, self._counts(cells), self.periodic)

    def _counts(self, cells: int) -> tuple[int, int]:
        """Columns and rows, nearest to so many cells, that fit the plane."""
        x_length, y_length = self.lengths
        rows_to_columns = y_length / (ROW * x_length)
        columns = np.arange(FEWEST_COLUMNS, int(np.sqrt(FARTHEST * cells / rows_to_columns)) + 2)
        even = 2 if "y" in self.periodic else 1
        rows = even * np.rint(rows_to_columns * columns / even)
        fit = np.abs(rows_to_columns * columns / np.maximum(rows, 1.0) - 1.0) <= ROUNDING
        far = np.where(fit & (rows >= FEWEST_ROWS), np.abs(np.log(columns * np.maximum(rows, 1.0) / cells)), np.inf)
        if not (len(far) and far.min() <= np.log(FARTHEST)):
            raise InputError(
                f"no regular hexagons, about {cells} of them, fit a plane of {x_length:.10g} by {y_length:.10g} m "
                f"periodic in {self.periodic}; the second must be sqrt(3)/2 of the first times rows / columns "
                "(--plane LX,LY, or the lengths of the case)"
            )
        best = int(np.argmin(far))
        return int(columns[best]), int(rows[best])


def plane_of_study(case: Case, lengths: Sequence[float] | None, periodic: str | None) -> StudyPlane | None:
    """The plane of a study of `case`, by default that which its parameters tell; None for cases on a sphere.

    Raises `InputError` where a plane does not go with the case, or has to be given.
    """
    if case.radius > 0.0:
        if lengths is not None or periodic is not None:
            raise InputError(f"{case.name} is on a sphere, and --plane and --periodic are of planes; leave them out")
        return None
    if lengths is None:
        told = [case.parameters().get(name) for name in LENGTHS]
        if None in told:
            raise InputError(f"{case.name} does not tell its plane; give --plane LX,LY, its lengths in metres")
        lengths = [float(length) for length in told if length is not None]
    told_by_case = case.periodic if isinstance(case, PlaneCase) else StudyPlane.periodic
    return StudyPlane((float(lengths[0]), float(lengths[1])), periodic or told_by_case)
