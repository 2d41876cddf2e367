"""The mesh of a run is hashed once, as that takes as long as many steps; all files have that one."""

import json
from pathlib import Path

import netCDF4
import pytest

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.files import io, whole_mesh
from swe import Simulation


def test_a_run_hashes_its_mesh_once(small_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hashed = []
    true_hash = io.mesh_hash

    def counted(mesh: VoronoiMesh) -> str:
        hashed.append(mesh)
        return true_hash(mesh)

    monkeypatch.setattr(io, "mesh_hash", counted)
    monkeypatch.setattr(whole_mesh, "mesh_hash", counted)
    simulation = Simulation(small_mesh, Williamson5(), tmp_path)
    simulation.run(days=0.25, progress=False)
    assert len(hashed) == 1
    expected = true_hash(simulation.mesh)
    assert json.loads((tmp_path / "run.json").read_text())["mesh_hash"] == expected
    for name in ("mesh.nc", "history.nc"):
        with netCDF4.Dataset(tmp_path / name) as file:
            assert file.file_id == expected[:10]
