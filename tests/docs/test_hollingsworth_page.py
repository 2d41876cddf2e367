"""The table and the figure on Hollingsworth instability, which only a checkout can make."""

from pathlib import Path

import pytest
from matplotlib.image import imread

import hollingsworth_page
from hollingsworth_page import (
    SCHEMES,
    Growth,
    Setting,
    departures,
    growth_figure,
    growth_rate,
    table_lines,
)
from mesh import VoronoiMesh
from postprocess.studies.table1_page import save


def test_a_run_that_fails_ends_its_line(icosahedral_mesh: VoronoiMesh) -> None:
    growth = departures(icosahedral_mesh, Setting(0.5, "ringler2010", 0.0), 10.0)
    assert growth.failed_on is not None
    assert growth.days[-1] < growth.failed_on <= growth.days[-1] + 0.5
    assert 0.0 < growth.departures[0] < growth.departures[-1]
    assert growth.on(9.5) is None
    assert growth.on(growth.days[0]) == growth.departures[0]


def test_held_flow_is_steady_and_its_disturbances_grow_where_they_are_not_damped(
    icosahedral_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Growth is that of the disturbance whatever its size; dissipation takes from it, another scheme does not."""
    free = growth_rate(icosahedral_mesh, Setting(5.0, "ringler2010", 0.0), 30, 20)
    assert 0.05 < free < 1.0
    assert growth_rate(icosahedral_mesh, Setting(5.0, "ringler2010", 4e16), 30, 20) < 0.8 * free
    assert growth_rate(icosahedral_mesh, Setting(5.0, "consistent", 0.0), 30, 20) == pytest.approx(free, rel=0.02)
    monkeypatch.setattr(hollingsworth_page, "DISTURBANCE", 0.01 * hollingsworth_page.DISTURBANCE)
    assert growth_rate(icosahedral_mesh, Setting(5.0, "ringler2010", 0.0), 30, 20) == pytest.approx(free, rel=1e-3)


def test_table_and_figure_have_every_setting(tmp_path: Path) -> None:
    found = {
        Setting(depth, scheme, dissipation): (Growth([10.0, 16.0], [0.01, 0.02 + depth], 16.5), 0.25)
        for depth in (50.0, 5.0)
        for dissipation in (0.0, 1e16)
        for scheme in SCHEMES
    }
    lines = table_lines(found)
    assert len(lines) == 6
    assert {line.count("|") for line in lines} == {10}
    assert lines[2] == "| 50 | 0e+00 | 10 | 1.00e-02 | 1.00e-02 | 16.5 | 16.5 | 0.250 | 0.250 |"
    assert lines[5].startswith("| 5 | 1e+16 | 16 | 5.02e+00 |")
    figure = growth_figure(found)
    assert [len(axes.get_lines()) for axes in figure.axes] == [8, 8]
    assert {line.get_linestyle() for line in figure.axes[0].get_lines()} == {"-", "--", "None"}
    assert save(figure, tmp_path, "hollingsworth") == "![hollingsworth](hollingsworth.png)"
    assert imread(tmp_path / "hollingsworth.png").std() > 0.05
