"""The tables and the figure of docs/scaling.md, which only a checkout can make."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

import scaling_counts
import scaling_page
import scaling_tables
from mesh import VoronoiMesh
from mesh.partition.cell_graph import cell_graph
from mesh.partition.curve import blocks_along_curve
from mesh.partition.partition import Partition
from mesh.triangulation.ordering import hilbert_keys
from postprocess.studies.table1_page import save
from scaling_counts import Counted
from scaling_page import exchange_lines, measured_exchanges, scaling_figure
from scaling_tables import (
    AS_BUILT,
    MENDED,
    METIS,
    METIS_OWN_FIRST,
    cause_lines,
    division_lines,
    resizing_lines,
    setting_lines,
    strong_lines,
    weak_counts,
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
    blocks = blocks_along_curve(hilbert_keys(mesh.cell_points), (mesh.cells_on_edge,), 8)
    expected = count_exchanges(cell_graph(mesh), mesh.cells_on_edge, Partition(blocks, 8), scaling_counts.RINGS)
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


def test_settings_differ_in_what_they_change(counted: Counted) -> None:
    curve_large, curve_small = (counted.counts(2562, parts, "curve") for parts in (4, 64))
    for setting in (AS_BUILT, MENDED):
        assert 0.0 < setting.time(curve_small).efficiency < setting.time(curve_large).efficiency < 1.0
    built, mended = AS_BUILT.time(curve_small), MENDED.time(curve_small)
    assert built.total > 1.5 * mended.total
    assert built.halo == 0.0
    assert 0.0 < mended.overhead < built.overhead  # values are still packed
    small = counted.counts(2562, 64, "METIS")
    assert METIS.time(small).halo > METIS_OWN_FIRST.time(small).halo == 0.0
    equal = replace(METIS, equal_blocks=True)
    assert METIS.time(small).imbalance > equal.time(small).imbalance == 0.0


def test_the_table_of_settings_takes_each_with_its_division(counted: Counted) -> None:
    efficiency = {line.split("|")[1].strip(): line.split("|")[-2].strip() for line in setting_lines(counted)[2:]}
    for name, setting in (("as built", AS_BUILT), ("METIS blocks", METIS)):
        counts = weak_counts(counted, 64, setting.division)
        assert efficiency[name] == f"{setting.time(counts).efficiency:.3f}"
    assert efficiency["latency 10 us"] < efficiency["rrk4"] < efficiency["as built"]
    assert efficiency["METIS blocks"] < efficiency["METIS, own cells numbered first"]
    assert efficiency["as built"] < efficiency["no calls from Python in a step"]


def test_the_figure_has_every_line(counted: Counted, tmp_path: Path) -> None:
    figure = scaling_figure(counted)
    assert [len(axes.get_lines()) for axes in figure.axes] == [5, 5, 5]
    weak, _, strong = (axes.get_lines()[0] for axes in figure.axes)
    assert weak.get_xdata().tolist() == [2, 4, 64]
    assert strong.get_ydata()[-1] == AS_BUILT.time(counted.counts(2562, 64, "curve")).efficiency
    assert save(figure, tmp_path, "scaling") == "![scaling](scaling.png)"
    assert imread(tmp_path / "scaling.png").std() > 0.05


@pytest.mark.slow
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
