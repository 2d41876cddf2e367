"""`trisk quality`: validate a mesh and measure it, or reproduce the published table."""

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from trisk.cli.options import Recompute


def quality(
    file: Annotated[Path | None, typer.Argument(help="MPAS mesh file.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    recompute_metrics: Recompute = False,
    table1: Annotated[
        bool, typer.Option("--table1", help="Reproduce Table 1 of Ju, Ringler and Gunzburger (2011) instead.")
    ] = False,
    max_level: Annotated[int, typer.Option("--max-level", help="Last level of the table, up to 9.")] = 6,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Write a page with the table and figures to this folder.")
    ] = None,
) -> None:
    """Validate a mesh file and measure its quality."""
    if (file is None) != table1:
        raise typer.BadParameter("give either a mesh file or --table1")
    if table1 and (as_json or recompute_metrics):
        raise typer.BadParameter("--json and --recompute-metrics go with a mesh file")
    if output is not None and not table1:
        raise typer.BadParameter("--output goes with --table1")
    if file is None:
        _make_table1(max_level, output)
    else:
        _measure(file, recompute_metrics, as_json)


def _make_table1(max_level: int, output: Path | None) -> None:
    from postprocess.runs.folders import require_possible_folder
    from trisk.report.table1 import print_table1

    if output is not None:
        require_possible_folder(output)
    print_table1(max_level, output)


def _measure(file: Path, recompute_metrics: bool, as_json: bool) -> None:
    from mesh import read_mesh
    from mesh.discrete.quality import quality_and_note
    from trisk.report.summaries import print_quality

    mesh = read_mesh(file, recompute_metrics)
    if not as_json:
        print_quality(mesh, str(file))
        return
    found, note = quality_and_note(mesh)
    measured = {name: value if math.isfinite(value) else None for name, value in asdict(found).items()}
    typer.echo(json.dumps({**measured, "residual_note": note}))
