"""`trisk compare`: error norms and conservation of runs."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer


def compare(
    run_directories: Annotated[list[Path], typer.Argument(help="Directories of runs of one case, on any meshes.")],
    reference: Annotated[
        str,
        typer.Option(
            "--reference",
            help="exact, a file of a spectral reference, or a run directory; auto is the exact solution, else the "
            "reference that comes with the case, else the first run.",
        ),
    ] = "auto",
    days: Annotated[
        list[float] | None,
        typer.Option("--day", help="Day to compare, repeatable; by default the last that all runs have."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="Folder for a report, report.html, and for maps of the last day; by default maps alone, in the "
            "figures folder of the first run.",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Compare runs with a solution or with each other.

    Prints what was found, error norms and conservation, and draws maps.
    """
    from postprocess.compare.comparison import compare_runs, comparison_record
    from postprocess.figures.compare_maps import write_maps
    from postprocess.reports.compare_report import ComparisonReport
    from postprocess.runs.folders import require_possible_folder
    from swe.output.files import FIGURES_FOLDER
    from trisk.report.comparison_table import print_comparison, print_verdict

    folder = output or run_directories[0] / FIGURES_FOLDER
    require_possible_folder(folder)
    comparison = compare_runs(*run_directories, reference=reference, days=days or ())
    report = ComparisonReport(comparison)
    if not as_json:
        print_verdict(report.verdict)
        print_comparison(comparison)
    maps = write_maps(comparison, folder)
    written = list(maps)
    if output is not None:
        written.append(report.write(maps, output, ["trisk", *sys.argv[1:]]))
    if as_json:
        typer.echo(json.dumps({**comparison_record(comparison), "maps": [str(path) for path in maps]}))
        return
    for path in written:
        typer.echo(path)
