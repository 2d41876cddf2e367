"""Spectra of runs drawn, beside the slopes of two-dimensional turbulence, and written to a folder with their table."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from mesh.safe_files import AnyPath
from postprocess.compare.spectra import Spectra, spectra_of, write_spectra
from postprocess.figures.plots import DOTS_PER_INCH
from postprocess.runs.folders import prepared_folder, require_possible_folder
from postprocess.runs.reading import Run

GUIDES = {"kinetic_energy": (-3.0, -5.0 / 3.0), "potential_enstrophy": (-1.0,)}
"""Slopes drawn for comparison: two-dimensional turbulence has -3, or -5/3, and -1."""

LABELS = {
    "kinetic_energy": "kinetic energy per mass (m² s⁻²)",
    "potential_enstrophy": "potential enstrophy (m⁻¹ s⁻²)",
}


def write_spectra_of(runs: Sequence[Run], days: Sequence[float], folder: AnyPath) -> list[Path]:
    """Write table and figure of the spectra of `runs` on `days`, by default the last; return their paths."""
    require_possible_folder(folder)
    spectra = [spectra_of(run, day) for run in runs for day in (days or (float(run.days[-1]),))]
    folder = prepared_folder(folder)
    table, picture = folder / "spectra.csv", folder / "spectra.png"
    write_spectra(spectra, table)
    spectra_figure(spectra).savefig(picture, dpi=DOTS_PER_INCH)
    return [table, picture]


def spectra_figure(spectra: Sequence[Spectra]) -> Figure:
    """Both spectra from wavenumber 1 on, one line a run and day, with the slopes of two-dimensional turbulence."""
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    for axes, (name, label) in zip(figure.subplots(1, 2), LABELS.items(), strict=True):
        for each in spectra:
            values = getattr(each, name)
            axes.loglog(np.arange(1, len(values)), values[1:], label=each.name, linewidth=1.2)
        highest = max(len(getattr(each, name)) for each in spectra)
        first = getattr(spectra[0], name)
        x = np.array([min(10.0, highest / 2.0, len(first) - 1.0), highest - 1.0])
        for slope, style in zip(GUIDES[name], ("--", ":"), strict=False):
            guide = 2.0 * first[int(x[0])] * (x / x[0]) ** slope
            axes.loglog(x, guide, color="grey", linestyle=style, label=f"slope {slope:.3g}")
        axes.set_xlabel(spectra[0].wavenumber_in_words)
        axes.set_ylabel(label)
        axes.grid(alpha=0.3, which="both")
        axes.legend(fontsize=7)
    figure.suptitle(f"Spectra of {spectra[0].run.case}")
    return figure
