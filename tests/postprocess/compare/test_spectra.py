import csv
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("ducc0")

from cases import find_case
from mesh import VoronoiMesh
from postprocess.compare.spectra import resolved_wavenumber, spectra_of
from postprocess.figures.spectra_figure import write_spectra_of
from postprocess.runs.reading import Run, read_run
from swe import Simulation


@pytest.fixture(scope="module")
def runs(larger_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> list[Run]:
    made = []
    for name in ("williamson2", "williamson6"):
        directory = tmp_path_factory.mktemp(name)
        Simulation(larger_mesh, find_case(name), directory).run(0.05, progress=False)
        made.append(read_run(directory))
    return made


def test_rotation_and_wave_are_where_they_belong(runs: list[Run]) -> None:
    """Solid-body rotation has wavenumber 1, the Rossby-Haurwitz wave beside it 5."""
    for run, wavenumbers in zip(runs, ((1,), (1, 5)), strict=True):
        energy = spectra_of(run, 0.0).kinetic_energy
        assert set(np.argsort(energy)[-len(wavenumbers) :]) == set(wavenumbers)
        assert energy[list(wavenumbers)].sum() > 0.99 * energy.sum()


def test_spectra_add_up_to_the_invariants(runs: list[Run]) -> None:
    for run in runs:
        spectra, area = spectra_of(run, 0.0), run.mesh.area_cell.sum()
        fields = run.snapshot(0.0).fields
        speed = fields["velocity_zonal"] ** 2 + fields["velocity_meridional"] ** 2
        kinetic_energy = 0.5 * np.sum(run.mesh.area_cell * speed) / area
        assert spectra.kinetic_energy.sum() == pytest.approx(kinetic_energy, rel=2e-3)
        enstrophy = run.series["potential_enstrophy"][0] / area
        assert spectra.potential_enstrophy.sum() == pytest.approx(enstrophy, rel=1e-2, abs=0.0)


def test_table_and_figure(runs: list[Run], tmp_path: Path) -> None:
    table, picture = write_spectra_of(runs, (0.0, 0.05), tmp_path / "spectra")
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 * (resolved_wavenumber(2562) + 1)
    assert {row["day"] for row in rows} == {"0.0", "0.05"}
    assert picture.stat().st_size > 10_000


def test_two_cells_a_wavelength() -> None:
    assert resolved_wavenumber(40962) == pytest.approx(2 * resolved_wavenumber(10242), abs=1)
