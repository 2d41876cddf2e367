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

from mesh.arrays import Array
from mesh.geometry.sphere import mean_spacing
from mesh.safe_files import name_in_text
from postprocess.compare.solutions import RunSolution
from postprocess.reference.harmonics import Harmonics
from postprocess.runs.reading import Run


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
    run.mesh.require_sphere("spectra are made")
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


def write_spectra(spectra: Sequence[Spectra], path: Path) -> None:
    """Write spectra as CSV, one line for each run, day and wavenumber."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["run", "cells", "day", "wavenumber", "kinetic_energy_m2_s-2", "potential_enstrophy_m-1_s-2"])
        for each in spectra:
            start = (name_in_text(each.run.directory.name), each.run.mesh.n_cells, each.day)
            for wavenumber, pair in enumerate(zip(each.kinetic_energy, each.potential_enstrophy, strict=True)):
                writer.writerow([*start, wavenumber, *pair])
