"""Spectra of runs: kinetic energy and potential enstrophy against wavenumber.

On a sphere they are by spherical harmonics and total wavenumber: fields of a run are remapped to a Gauss-Legendre grid.
On a plane that repeats itself in both directions they are by Fourier series, see `postprocess.compare.fourier`. Both
are spectra of squares, so that their sums over all wavenumbers are what the surface holds: kinetic energy per mass of
the velocity, potential enstrophy per area, h q^2 / 2, of sqrt(h) q.
"""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mesh.arrays import Array
from mesh.geometry.sphere import mean_spacing
from mesh.geometry.surface import surface_of
from mesh.safe_files import name_in_text
from mesh.shown import in_kilometres
from postprocess.compare.fourier import Fourier
from postprocess.compare.solutions import RunSolution
from postprocess.reference.harmonics import Harmonics
from postprocess.runs.reading import Run
from swe.errors import InputError


@dataclass(frozen=True, eq=False)
class Spectra:
    """Spectra of one run on one day by wavenumber 0, 1, ..., per wavenumber."""

    run: Run
    day: float
    kinetic_energy: Array
    potential_enstrophy: Array

    @property
    def name(self) -> str:
        """Run and day, for legends."""
        return f"{name_in_text(self.run.directory.name)}, {self.run.mesh.n_cells} cells, day {self.day:g}"

    @property
    def wavenumber_in_words(self) -> str:
        """What the wavenumber is, for axes."""
        mesh = self.run.mesh
        if mesh.on_a_sphere:
            return "total wavenumber"
        return f"wavenumber (waves in {in_kilometres(max(mesh.x_period, mesh.y_period))})"


def resolved_wavenumber(n_cells: int) -> int:
    """Highest total wavenumber with two cells a wavelength on a uniform mesh."""
    return int(np.pi / mean_spacing(n_cells))


def spectra_of(run: Run, day: float) -> Spectra:
    """Spectra of the snapshot of `day` up to the wavenumber that a uniform mesh of as many cells resolves.

    Raises `InputError` on a plane that does not repeat itself in both directions.
    """
    if not run.mesh.on_a_sphere:
        return _on_plane(run, day)
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


def _on_plane(run: Run, day: float) -> Spectra:
    mesh, surface = run.mesh, surface_of(run.mesh)
    if not surface.handles:
        raise InputError(
            f"spectra are of spheres and of planes that repeat themselves in x and in y, and {run.directory} is on a "
            "plane with walls; name another run"
        )
    longer = max(mesh.x_period, mesh.y_period)
    resolved = int(0.5 * longer / surface.mean_spacing(mesh.n_cells, surface.area))
    fourier, solution = Fourier((mesh.x_period, mesh.y_period), resolved), RunSolution(run)
    x, y = fourier.points
    along, across = solution.velocity(x, y, day)
    potential_vorticity = solution.from_vertices(x, y).scalar(run.snapshot(day).fields["potential_vorticity"])
    weighted = np.sqrt(solution.thickness(x, y, day)) * potential_vorticity
    kinetic_energy = 0.5 * (fourier.power(along) + fourier.power(across))
    return Spectra(run, day, kinetic_energy, 0.5 * fourier.power(weighted))


def write_spectra(spectra: Sequence[Spectra], path: Path) -> None:
    """Write spectra as CSV, one line for each run, day and wavenumber."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["run", "cells", "day", "wavenumber", "kinetic_energy_m2_s-2", "potential_enstrophy_m-1_s-2"])
        for each in spectra:
            start = (name_in_text(each.run.directory.name), each.run.mesh.n_cells, each.day)
            for wavenumber, pair in enumerate(zip(each.kinetic_energy, each.potential_enstrophy, strict=True)):
                writer.writerow([*start, wavenumber, *pair])
