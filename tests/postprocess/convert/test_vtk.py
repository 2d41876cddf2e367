"""Series of VTK files: VTK's reader finds cells, values, units and times."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pytest

from postprocess.convert.conversion import convert_run
from postprocess.runs.reading import open_run


def opened(path: Path) -> Any:
    """The grid of a .vtu file, read without an error."""
    reader = pytest.importorskip("vtkmodules.vtkIOXML").vtkXMLUnstructuredGridReader()
    errors: list[str] = []

    def report(_: object, __: str, text: str) -> None:
        errors.append(text)

    report.CallDataType = "string0"  # type: ignore[attr-defined]
    reader.AddObserver("ErrorEvent", report)
    assert reader.CanReadFile(str(path))
    reader.SetFileName(str(path))
    reader.Update()
    assert not errors
    return reader.GetOutput()


def as_numpy(array: Any) -> np.ndarray:
    return pytest.importorskip("vtkmodules.util.numpy_support").vtk_to_numpy(array)


def files_and_times(path: Path) -> tuple[list[Path], list[float]]:
    """What a .pvd file lists."""
    entries = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    return [path.parent / entry.attrib["file"] for entry in entries], [float(e.attrib["timestep"]) for e in entries]


def test_cells_have_the_values_of_every_snapshot(any_run: Path, tmp_path: Path) -> None:
    paths = convert_run(any_run, "vtk", tmp_path / "out")
    assert paths == [tmp_path / "out" / "cells.pvd", tmp_path / "out" / "edges.pvd"]
    files, times = files_and_times(paths[0])
    run = open_run(any_run)
    mesh = run.mesh
    assert times == run.days.tolist()
    assert len(times) == 3
    for row, path in enumerate(files):
        grid = opened(path)
        assert (grid.GetNumberOfCells(), grid.GetNumberOfPoints()) == (mesh.n_cells, mesh.n_vertices)
        assert grid.GetFieldData().GetArray("TimeValue").GetValue(0) == times[row]
        with netCDF4.Dataset(any_run / "history.nc") as source:
            for name in ("thickness", "velocity_zonal", "kinetic_energy"):
                np.testing.assert_array_equal(as_numpy(grid.GetCellData().GetArray(name)), source[name][row])
            for name in ("relative_vorticity", "potential_vorticity"):
                np.testing.assert_array_equal(as_numpy(grid.GetPointData().GetArray(name)), source[name][row])
            np.testing.assert_array_equal(as_numpy(grid.GetCellData().GetArray("topography")), source["topography"][:])


def test_cells_are_polygons_seen_from_outside(any_run: Path, tmp_path: Path) -> None:
    convert_run(any_run, "vtk", tmp_path / "out")
    mesh = open_run(any_run).mesh
    grid = opened(tmp_path / "out" / "cells_00000.vtu")
    for number in (0, 5, mesh.n_cells - 1):
        cell = grid.GetCell(number)
        assert cell.GetCellType() == 7
        ring = [cell.GetPointId(corner) for corner in range(cell.GetNumberOfPoints())]
        assert ring == mesh.vertices_on_cell[number, : mesh.n_edges_on_cell[number]].tolist()
        a, b, c = (np.array(grid.GetPoint(corner)) for corner in ring[:3])
        assert np.cross(b - a, c - b) @ a > 0.0
    assert np.linalg.norm(grid.GetPoint(3)) == pytest.approx(mesh.sphere_radius)


def test_edges_are_lines_with_their_velocity(any_run: Path, tmp_path: Path) -> None:
    convert_run(any_run, "vtk", tmp_path / "out")
    mesh = open_run(any_run).mesh
    files, _ = files_and_times(tmp_path / "out" / "edges.pvd")
    grid = opened(files[-1])
    velocity = grid.GetCellData().GetArray("normal_velocity")
    assert velocity.GetInformation().Get(velocity.UNITS_LABEL()) == "m s-1"
    with netCDF4.Dataset(any_run / "history.nc") as source:
        np.testing.assert_array_equal(as_numpy(velocity), source["normal_velocity"][-1])
    ends = grid.GetCell(11)
    assert [ends.GetPointId(0), ends.GetPointId(1)] == mesh.vertices_on_edge[11].tolist()
    assert ends.GetCellType() == 3
