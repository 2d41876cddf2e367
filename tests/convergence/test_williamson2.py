"""Steady geostrophic flow over five days: the error in thickness falls as it should from mesh to mesh."""

import numpy as np
import pytest

from cases import Williamson2
from mesh import VoronoiMesh, scvt_mesh
from postprocess.compare.norms import scalar_norms
from swe import Simulation

EXPECTED = {642: 2.106e-3, 2562: 5.444e-4, 10242: 1.387e-4}
"""l2 norm of the error in thickness at day 5, made by an independent program on the same kind of meshes."""


def error_after_five_days(mesh: VoronoiMesh) -> float:
    case = Williamson2()
    simulation = Simulation(mesh, case)
    simulation.run(days=5, progress=False)
    exact = case.state_on(simulation.mesh, simulation.time)
    return scalar_norms(simulation.state.thickness, exact.thickness, simulation.mesh.area_cell).l2


def test_errors_of_steady_flow() -> None:
    errors = {cells: error_after_five_days(scvt_mesh(cells)) for cells in EXPECTED}
    for cells, expected in EXPECTED.items():
        assert errors[cells] == pytest.approx(expected, rel=0.02), cells
    assert Williamson2.convergence_order is not None
    assert np.log2(errors[2562] / errors[10242]) > Williamson2.convergence_order
