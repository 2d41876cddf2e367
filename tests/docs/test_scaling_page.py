"""The tables and the figure of docs/scaling.md, which only a checkout can make."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

import scaling_counts
import scaling_page
import scaling_tables
from mesh import VoronoiMesh
from mesh.partition.cell_graph import cell_graph
from mesh.partition.curve import partition_along_curve
from postprocess.studies.table1_page import save
from scaling_counts import Counted
from scaling_page import exchange_lines, measured_exchanges, scaling_figure
from scaling_tables import (
    AS_BUILT,
    MENDED,
    cause_lines,
    division_lines,
    resizing_lines,
    setting_lines,
    strong_lines,
    weak_lines,
)
from swe.parallel.exchange_counts import count_exchanges
from tests.under_mpiexec import needs_mpi

SMALL = {
    "CELLS": (642, 2562),
    "PARTS": (2, 4, 64),
    "COUNTED": {2: 162, 4: 642},
    "SPREAD_OF": 2562,
    "SIZES_OF": 4,
    "MANY": 64,
    "RESIZED": (16,),
    "WEAK_CELLS": 160,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("scaling")


@pytest.fixture
def counted(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Counted:
    pytest.importorskip("pymetis", reason="pymetis is not installed; pip install 'trisk[mpi]' brings it")
    for module in (scaling_tables, scaling_page):
        for name, value in SMALL.items():
            if hasattr(module, name):
                monkeypatch.setattr(module, name, value)
    return Counted(folder)


def test_counts_are_those_of_the_mesh_that_the_command_makes(
    counted: Counted, folder: Path, icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Counted once: what is kept is the answer the second time."""
    mesh = icosahedral_mesh
    expected = count_exchanges(
        cell_graph(mesh), mesh.cells_on_edge, partition_along_curve(mesh.cell_points, 8), scaling_counts.RINGS
    )
    found = counted.counts(642, 8, "curve")
    np.testing.assert_array_equal(found.values_sent, expected.values_sent)
    np.testing.assert_array_equal(found.halo_cells, expected.halo_cells)
    monkeypatch.setattr(scaling_counts, "generate_scvt", None)
    monkeypatch.setattr(scaling_counts, "count_exchanges", None)
    np.testing.assert_array_equal(Counted(folder).counts(642, 8, "curve").values_sent, expected.values_sent)
    assert not np.array_equal(counted.counts(642, 8, "curve").own_cells, [642])


def test_tables_have_every_row(counted: Counted) -> None:
    sizes = {
        division_lines: 2 * 3,
        weak_lines: 3 * 2,
        setting_lines: len(scaling_tables.SETTINGS),
        strong_lines: 2 * 3,
        cause_lines: 3,
        resizing_lines: 2,
    }
    for lines, rows in sizes.items():
        found = lines(counted)
        assert len(found) == 2 + rows
        assert len({line.count("|") for line in found}) == 1
    assert [line.split("|")[2].strip() for line in weak_lines(counted)[2:]] == [
        *("81, counted", "81, counted", "160, counted", "160, counted", "160, resized", "160, resized")
    ]
    curve, metis = (counted.counts(642, 4, division) for division in ("curve", "METIS"))
    excess = curve.bytes_sent.mean() / metis.bytes_sent.mean() - 1.0
    assert f"| {excess:+.0%} |" in division_lines(counted)[3]


def test_mended_is_faster_than_as_built_and_large_parts_are_more_efficient(counted: Counted) -> None:
    large, small = (counted.counts(2562, parts, "METIS") for parts in (4, 64))
    for setting in (AS_BUILT, MENDED):
        assert 0.0 < setting.time(small).efficiency < setting.time(large).efficiency < 1.0
    assert AS_BUILT.time(small).total > 1.5 * MENDED.time(small).total
    assert MENDED.time(small).halo == 0.0
    assert 0.0 < MENDED.time(small).overhead < AS_BUILT.time(small).overhead  # values are still packed
    equal = scaling_tables.SETTINGS["blocks of equal size"]
    assert AS_BUILT.time(small).imbalance > equal.time(small).imbalance == 0.0
    efficiency = {line.split("|")[1].strip(): float(line.split("|")[-2]) for line in setting_lines(counted)[2:]}
    assert efficiency["latency 10 us"] < efficiency["rrk4"] < efficiency["as built"] < efficiency["both"]


def test_the_figure_has_every_line(counted: Counted, tmp_path: Path) -> None:
    figure = scaling_figure(counted)
    assert [len(axes.get_lines()) for axes in figure.axes] == [4, 4, 4]
    weak, _, strong = (axes.get_lines()[0] for axes in figure.axes)
    assert weak.get_xdata().tolist() == [2, 4, 64]
    assert strong.get_ydata()[-1] == AS_BUILT.time(counted.counts(2562, 64, "METIS")).efficiency
    assert save(figure, tmp_path, "scaling") == "![scaling](scaling.png)"
    assert imread(tmp_path / "scaling.png").std() > 0.05


@needs_mpi
def test_two_processes_measure_an_exchange(tmp_path: Path) -> None:
    (found,) = measured_exchanges(tmp_path, (162,))
    assert (found["cells"], found["messages"]) == (162, 1)
    assert 81 < found["part_cells"] < 162
    assert found["bytes_sent"] > 8 * 20
    for name in ("exchange", "step", "alone"):
        quick, median = found[name]
        assert 0.0 < quick <= median < 10.0
    assert found["exchange"][0] < found["step"][0]
    _, _, row = exchange_lines([found])
    assert row.startswith(f"| 162 | {found['part_cells']} | 1 | {found['bytes_sent']} |")
