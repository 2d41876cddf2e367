from pathlib import Path

import numpy as np
import pytest

from cases import LakeAtRest
from mesh import VoronoiMesh
from mesh.integrals.quadrature import Sampling
from swe import Simulation
from swe.output.files import read_series


@pytest.mark.parametrize("sampling", ["point", "mean"])
def test_lake_stays_at_rest_on_any_mesh(any_mesh: VoronoiMesh, sampling: Sampling) -> None:
    simulation = Simulation(any_mesh, LakeAtRest(), sampling=sampling, time_step=50.0)
    assert simulation.model.topography.max() > 300.0
    rate = simulation.state.empty_like()
    simulation.model.tendency(simulation.state, rate)
    assert not rate.thickness.any()
    assert np.abs(rate.normal_velocity * simulation.mesh.dc_edge).max() < 1e-10


def test_diagnostics_of_a_lake_are_round_off(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    """Nothing is divided by an available energy that is round-off itself."""
    simulation = Simulation(icosahedral_mesh, LakeAtRest(), tmp_path)
    simulation.run(days=2, progress=False)
    assert np.abs(simulation.state.normal_velocity).max() < 1e-9
    series = read_series(tmp_path / "diagnostics.nc")
    for name, values in series.items():
        assert np.all(np.isfinite(values)), name
        if "change" in name:
            assert np.abs(values).max() < 1e-13, name
