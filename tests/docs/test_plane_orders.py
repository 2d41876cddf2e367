"""The tool that measures the orders of the exact cases on planes, and those orders."""

from functools import cache

import numpy as np
import pytest

from cases import Manufactured
from cases.plane.base import ExactCase
from mesh import VoronoiMesh, mesh_on_plane
from mesh.discrete.operators import build_operators, normal_component
from mesh.integrals.quadrature import normal_means
from mesh.mesh_request import MeshRequest
from plane_orders import CASES, PLANE, errors_of, orders, table, velocity_of_the_equations


@cache
def uneven_mesh(cells: int) -> VoronoiMesh:
    return mesh_on_plane(MeshRequest(cells, plane=PLANE, periodic="xy", start="random"))


def test_the_velocity_has_the_exact_vorticity_and_divergence() -> None:
    uneven = uneven_mesh(400)
    case, time, operators = Manufactured(), 7e3, build_operators(uneven)
    found = velocity_of_the_equations(uneven, case, time)
    midpoints = normal_component(uneven, *case.velocity(uneven.x_edge, uneven.y_edge, time))
    means = normal_means(uneven, case.evaluated_velocity(time))
    vorticity, divergence = operators.curl @ midpoints, operators.divergence @ means
    np.testing.assert_allclose(operators.curl @ found, vorticity, atol=1e-10 * np.abs(vorticity).max())
    np.testing.assert_allclose(operators.divergence @ found, divergence, atol=1e-10 * np.abs(divergence).max())
    # It is neither of the two.
    assert np.abs(operators.divergence @ midpoints - divergence).max() > 0.02 * np.abs(divergence).max()
    assert np.abs(operators.curl @ means - vorticity).max() > 0.02 * np.abs(vorticity).max()


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
@pytest.mark.parametrize("cells", [400, pytest.param(1600, marks=pytest.mark.slow)])
def test_the_consistent_scheme_keeps_its_order_on_uneven_cells(case: ExactCase, cells: int) -> None:
    coarse, fine = (errors_of(case, uneven_mesh(number), "consistent") for number in (cells, 4 * cells))
    assert 1.9 < orders(coarse, fine).height < 2.1
    assert 1.9 < orders(coarse, fine).velocity < 2.1
    assert fine.velocity < fine.midpoints


def test_the_table_has_a_line_for_each_run() -> None:
    title, rule, *lines = table([100, 400])
    assert rule.count("|") == title.count("|")
    entries = [[entry.strip() for entry in line.split("|")[1:-1]] for line in lines]
    assert [row[:2] for row in entries[1:4]] == [
        ["", "400"],
        ["`inertia-gravity-wave`, `consistent`", "100"],
        ["", "400"],
    ]
    assert all(row[3::2] == ["", "", ""] for row in entries[::2])
    for coarse, fine in zip(entries[::2], entries[1::2], strict=True):
        for column in (2, 4, 6):
            assert abs(np.log2(float(coarse[column]) / float(fine[column])) - float(fine[column + 1])) < 0.02
