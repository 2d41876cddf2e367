"""What 50 days of test case 5 conserve, and how RK4's drift falls: python tests/reliability/conservation.py FOLDER.

Prints the tables of docs/reliability.md; the runs stay in FOLDER, and go on where they were interrupted. Half an hour.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from cases import Williamson5
from mesh import VoronoiMesh, read_mesh, scvt_mesh, write_mesh
from mesh.density.gridded import find_density
from mesh.discrete.build import mesh_from_points
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Limits
from mesh.geometry.sphere import normalize
from postprocess.compare.comparison import compare_runs
from swe import Simulation
from swe.output.files import DIAGNOSTICS_FILE, read_series

SECONDS_PER_DAY = 86400.0
STEPS = (600.0, 300.0, 150.0)
SCHEMES: dict[str, dict[str, object]] = {
    "rk4": {},
    "rrk4": {"integrator": "rrk4"},
    "rrk4-apvm": {"integrator": "rrk4", "anticipation": 0.5},
    "rrk4-consistent": {"integrator": "rrk4", "scheme": "consistent"},
    "rfbrk3": {"integrator": "rfbrk3"},
}


def nested_mesh() -> VoronoiMesh:
    """2562 cells, refined in a circle."""
    coarse, density = scvt_mesh(2562), find_density("refined-circle")
    found = nested_scvt(normalize(coarse.cell_points), coarse.cells_on_vertex, density, limits=Limits(1e-6))
    return mesh_from_points(found.points, found.triangles, density, "refined-circle")


MESHES = {
    "scvt": lambda: scvt_mesh(10242),
    "refined-circle": lambda: scvt_mesh(10242, density="refined-circle"),
    "nested": nested_mesh,
}


def made(folder: Path, name: str) -> VoronoiMesh:
    """The mesh of that name, made unless it is there already."""
    path = folder / f"{name}.nc"
    if not path.exists():
        write_mesh(MESHES[name](), path)
    return read_mesh(path)


def series_of(mesh: VoronoiMesh, directory: Path, days: float, **options: object) -> dict[str, np.ndarray]:
    """Diagnostics of a run."""
    Simulation(mesh, Williamson5(), directory, resume=True, **options).run(until=days)
    return read_series(directory / DIAGNOSTICS_FILE)


def largest(series: dict[str, np.ndarray], name: str) -> float:
    """Largest magnitude in the course of a run."""
    return float(np.abs(series[name]).max())


def print_conservation(folder: Path) -> None:
    """Largest changes, and the work of terms that cancel by the kinetic energy and a day."""
    print("| mesh | cells | scheme | energy | mass | absolute vorticity | Coriolis work | exchange | enstrophy |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name in MESHES:
        mesh = made(folder, name)
        for scheme, options in SCHEMES.items():
            series = series_of(mesh, folder / f"{name}-{scheme}", 50.0, **options)
            turnover = series["kinetic_energy"].min() / SECONDS_PER_DAY
            values = (
                largest(series, "total_energy_change_of_total"),
                largest(series, "mass_change"),
                largest(series, "absolute_vorticity_change"),
                largest(series, "total_energy_rate_coriolis") / turnover,
                largest(series, "total_energy_rate_exchange") / turnover,
            )
            row = (name, str(mesh.n_cells), scheme, *(f"{value:.1e}" for value in values))
            print("| " + " | ".join(row) + f" | {series['potential_enstrophy_change'][-1]:+.3f} |")


def print_errors(folder: Path) -> None:
    """Error of thickness at day 15 on the SCVT, with both integrators."""
    comparison = compare_runs(folder / "scvt-rk4", folder / "scvt-rrk4", reference="auto", days=[15.0])
    for entry in comparison.entries:
        print(f"l2 of thickness at day 15, {entry.run.directory.name}: {entry.norms['thickness'].l2:.4e}")


def print_orders(folder: Path) -> None:
    """Drift of energy in 15 days on 2562 cells, by the time step."""
    mesh = scvt_mesh(2562)
    print("| time step, s | energy | order |")
    print("|---|---|---|")
    before = float("nan")
    for step in STEPS:
        series = series_of(mesh, folder / f"step-{step:g}", 15.0, time_step=step)
        drift = abs(series["total_energy_change_of_total"][-1])
        print(f"| {step:g} | {drift:.2e} | {np.log2(before / drift):.2f} |")
        before = drift


def draw(folder: Path, path: Path) -> None:
    """Changes of energy and of potential enstrophy on the SCVT, by scheme."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for scheme in SCHEMES:
        series = read_series(folder / f"scvt-{scheme}" / DIAGNOSTICS_FILE)
        days = series["time"][1:] / SECONDS_PER_DAY
        left.semilogy(days, np.maximum(np.abs(series["total_energy_change_of_total"][1:]), 1e-18), label=scheme)
        right.plot(days, 100.0 * series["potential_enstrophy_change"][1:], label=scheme)
    left.set(xlabel="time (days)", ylabel="|change of total energy| / total energy", title="Total energy")
    right.set(xlabel="time (days)", ylabel="change (percent)", title="Potential enstrophy")
    for axes in (left, right):
        axes.grid(alpha=0.4)
        axes.set_xlim(0.0, 50.0)
    left.legend()
    figure.suptitle("Test case 5 on 10242 cells")
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    print_conservation(target)
    draw(target, target / "reliability.png")
    print_errors(target)
    print_orders(target)
