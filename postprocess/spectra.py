"""Spectra of runs: kinetic energy and potential enstrophy against total wavenumber, by spherical harmonics.

Fields of a run are remapped to a Gauss-Legendre grid. Both are spectra of squares, so that their sums over all
wavenumbers are what the sphere holds: kinetic energy per mass of the velocity, potential enstrophy per area, h q^2 / 2,
of sqrt(h) q.
"""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from mesh.arrays import Array
from mesh.files import AnyPath, name_in_text
from mesh.moments import mean_spacing
from postprocess.folders import prepared_folder, require_possible_folder
from postprocess.harmonics import Harmonics
from postprocess.plots import DOTS_PER_INCH
from postprocess.runs import Run
from postprocess.solutions import RunSolution

GUIDES = {"kinetic_energy": (-3.0, -5.0 / 3.0), "potential_enstrophy": (-1.0,)}
"""Slopes drawn for comparison: two-dimensional turbulence has -3, or -5/3, and -1."""

LABELS = {
    "kinetic_energy": "kinetic energy per mass (m² s⁻²)",
    "potential_enstrophy": "potential enstrophy (m⁻¹ s⁻²)",
}


@dataclass(frozen=True, eq=False)
class Spectra:
    """Spectra of one run on one day by total wavenumber 0, 1, ..., per wavenumber."""

    run: Run
    day: float
    kinetic_energy: Array
    potential_enstrophy: Array

    @property
    def name(self) -> str:
        """Run and day, for legends."""
        return f"{name_in_text(self.run.directory.name)}, {self.run.mesh.n_cells} cells, day {self.day:g}"


def resolved_wavenumber(n_cells: int) -> int:
    """Highest total wavenumber with two cells a wavelength on a uniform mesh."""
    return int(np.pi / mean_spacing(n_cells))


def spectra_of(run: Run, day: float) -> Spectra:
    """Spectra of the snapshot of `day` up to the wavenumber that a uniform mesh of as many cells resolves."""
    mesh, fields = run.mesh, run.snapshot(day).fields
    harmonics = Harmonics(resolved_wavenumber(mesh.n_cells), mesh.sphere_radius)
    shape = harmonics.points[0].shape
    longitude, latitude = (angle.ravel() for angle in harmonics.points)
    solution = RunSolution(run)
    zonal, meridional = solution.velocity(longitude, latitude, day)
    curl, divergence = harmonics.curl_and_divergence(zonal.reshape(shape), meridional.reshape(shape))
    rotational, divergent = harmonics.potential_speeds(curl), harmonics.potential_speeds(divergence)
    thickness = solution.thickness(longitude, latitude, day)
    potential_vorticity = solution.from_vertices(longitude, latitude).scalar(fields["potential_vorticity"])
    weighted = harmonics.from_grid((np.sqrt(thickness) * potential_vorticity).reshape(shape))
    return Spectra(
        run,
        day,
        0.5 * (harmonics.power(rotational) + harmonics.power(divergent)),
        0.5 * harmonics.power(weighted),
    )


def write_spectra_of(runs: Sequence[Run], days: Sequence[float], folder: AnyPath) -> list[Path]:
    """Write table and figure of the spectra of `runs` on `days`, by default the last; return their paths."""
    require_possible_folder(folder)
    spectra = [spectra_of(run, day) for run in runs for day in (days or (float(run.days[-1]),))]
    folder = prepared_folder(folder)
    table, picture = folder / "spectra.csv", folder / "spectra.png"
    write_spectra(spectra, table)
    spectra_figure(spectra).savefig(picture, dpi=DOTS_PER_INCH)
    return [table, picture]


def write_spectra(spectra: Sequence[Spectra], path: Path) -> None:
    """Write spectra as CSV, one line for each run, day and wavenumber."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["run", "cells", "day", "wavenumber", "kinetic_energy_m2_s-2", "potential_enstrophy_m-1_s-2"])
        for each in spectra:
            start = (name_in_text(each.run.directory.name), each.run.mesh.n_cells, each.day)
            for wavenumber, pair in enumerate(zip(each.kinetic_energy, each.potential_enstrophy, strict=True)):
                writer.writerow([*start, wavenumber, *pair])


def spectra_figure(spectra: Sequence[Spectra]) -> Figure:
    """Both spectra from wavenumber 1 on, one line a run and day, with the slopes of two-dimensional turbulence."""
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    for axes, (name, label) in zip(figure.subplots(1, 2), LABELS.items(), strict=True):
        for each in spectra:
            values = getattr(each, name)
            axes.loglog(np.arange(1, len(values)), values[1:], label=each.name, linewidth=1.2)
        highest = max(len(getattr(each, name)) for each in spectra)
        first = getattr(spectra[0], name)
        x = np.array([min(10.0, highest / 2.0), highest - 1.0])
        for slope, style in zip(GUIDES[name], ("--", ":"), strict=False):
            guide = 2.0 * first[int(x[0])] * (x / x[0]) ** slope
            axes.loglog(x, guide, color="grey", linestyle=style, label=f"slope {slope:.3g}")
        axes.set_xlabel("total wavenumber")
        axes.set_ylabel(label)
        axes.grid(alpha=0.3, which="both")
        axes.legend(fontsize=7)
    figure.suptitle(f"Spectra of {spectra[0].run.case}")
    return figure
