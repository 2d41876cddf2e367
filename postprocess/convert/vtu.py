"""Files of VTK's XML format for unstructured grids (.vtu), numbers as raw bytes behind the XML, and series of them."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array

POLYGON, LINE = 7, 3
"""VTK's numbers of the types of cells."""

TYPES = {"f": "Float", "i": "Int", "u": "UInt"}

HEAD = np.dtype(np.uint64)
"""Type of the number of bytes that stands before those of each array."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Points (n, 3), m, and cells of one type: the numbers of their points one after another, and where each ends."""

    points: Array
    connectivity: NDArray[np.int64]
    ends: NDArray[np.int64]
    cell_type: int


@dataclass(frozen=True, eq=False)
class Values:
    """Values (n,) at all cells or all points of a grid, and their units."""

    values: Array
    units: str


class _Appended:
    """Arrays whose bytes follow the XML, and the elements that say where."""

    def __init__(self) -> None:
        self._arrays: list[NDArray] = []
        self._size = 0

    def element(self, name: str, values: NDArray, units: str = "", components: int = 1) -> str:
        """The element of an array, whose bytes are written later."""
        array = np.ascontiguousarray(values)
        kind = f"{TYPES[array.dtype.kind]}{8 * array.dtype.itemsize}"
        opening = (
            f'<DataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{components}" '
            f'format="appended" offset="{self._size}"'
        )
        self._arrays.append(array)
        self._size += HEAD.itemsize + array.nbytes
        if not units:
            return f"{opening}/>\n"
        key = f'<InformationKey name="UNITS_LABEL" location="vtkDataArray">{units}</InformationKey>'
        return f"{opening}>{key}</DataArray>\n"

    def write(self, file: BinaryIO) -> None:
        """Write the bytes of all arrays."""
        for array in self._arrays:
            file.write(HEAD.type(array.nbytes).tobytes())
            file.write(array.reshape(-1).data)


def write_vtu(
    path: Path, grid: Grid, at_cells: Mapping[str, Values], at_points: Mapping[str, Values], time: float
) -> None:
    """Write a grid with values of one moment, `time` in days; raises `OSError` where `path` cannot be written."""
    appended = _Appended()
    points, cells = len(grid.points), len(grid.ends)
    types = np.full(cells, grid.cell_type, dtype=np.uint8)
    byte_order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    parts = [
        '<?xml version="1.0"?>\n',
        f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{byte_order}" header_type="UInt64">\n',
        "<UnstructuredGrid>\n<FieldData>\n",
        f'<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time!r}</DataArray>\n',
        f'</FieldData>\n<Piece NumberOfPoints="{points}" NumberOfCells="{cells}">\n',
        "<PointData>\n",
        *(appended.element(name, each.values, each.units) for name, each in at_points.items()),
        "</PointData>\n<CellData>\n",
        *(appended.element(name, each.values, each.units) for name, each in at_cells.items()),
        "</CellData>\n<Points>\n",
        appended.element("Points", grid.points, "m", components=3),
        "</Points>\n<Cells>\n",
        appended.element("connectivity", grid.connectivity),
        appended.element("offsets", grid.ends),
        appended.element("types", types),
        '</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_',
    ]
    with path.open("wb") as file:
        file.write("".join(parts).encode())
        appended.write(file)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


def write_series(path: Path, names: Sequence[str], times: Sequence[float]) -> None:
    """Write the file (.pvd) that gives each of the files `names` beside it a time."""
    lines = [
        f'<DataSet timestep="{time!r}" part="0" file={quoteattr(name)}/>\n'
        for name, time in zip(names, times, strict=True)
    ]
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
        + "".join(lines)
        + "</Collection>\n</VTKFile>\n"
    )
