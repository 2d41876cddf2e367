import subprocess
import sys
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from cases import Williamson5
from mesh import VoronoiMesh
from postprocess.figures.plots import draw_conservation, field_figure, mesh_figure, plot_run
from postprocess.runs.reading import read_run
from swe import Simulation
from swe.errors import InputError


@pytest.fixture(scope="module")
def run_directory(icosahedral_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("run")
    Simulation(icosahedral_mesh, Williamson5(), directory).run(days=1, progress=False)
    return directory


def test_all_figures_are_drawn(run_directory: Path) -> None:
    paths = plot_run(read_run(run_directory), run_directory / "figures")
    names = {path.stem for path in paths}
    assert names == {"potential_vorticity", "kinetic_energy", "surface_height", "mesh", "conservation"}
    for path in paths:
        assert imread(path).std() > 0.05, f"{path} is blank"


def test_figures_have_labels_and_units(run_directory: Path) -> None:
    run = read_run(run_directory)
    maps = field_figure(run.mesh, run.mesh.area_cell, "Title", "area (m²)")
    assert [axes.get_xlabel() for axes in maps.axes][-1] == "area (m²)"
    assert maps.get_suptitle() == "Title"
    panel = Figure().subplots()
    conservation = draw_conservation(panel, run.series, "a run")
    assert conservation is panel
    assert conservation.get_xlabel() == "time (days)"
    assert conservation.get_yscale() == "log"
    assert len(conservation.get_lines()) == 5
    assert "642 cells" in mesh_figure(run.mesh).get_suptitle()


def test_last_snapshot(run_directory: Path) -> None:
    snapshot = read_run(run_directory).last_snapshot()
    assert snapshot.day == 1.0
    assert snapshot.fields["thickness"].shape == (642,)


def test_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no readable run"):
        read_run(tmp_path)


def test_the_backend_and_the_settings_of_the_user_stay() -> None:
    program = (
        "import matplotlib; matplotlib.use('svg'); before = dict(matplotlib.rcParams)\n"
        "import postprocess.figures.plots, postprocess.figures.compare_maps, postprocess.compare.spectra\n"
        "import postprocess.reports.study_report\n"
        "print(matplotlib.get_backend(), dict(matplotlib.rcParams) == before)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["svg", "True"]
