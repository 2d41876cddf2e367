"""The page of `trisk view`: one HTML file that holds the program, the cells and the values of all snapshots."""

import json
import re
from collections.abc import Iterator, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.geometry.surface import surface_of
from mesh.safe_files import AnyPath, written_aside
from mesh.voronoi_mesh import VoronoiMesh, mesh_in_words
from postprocess.runs.folders import require_possible_folder
from postprocess.runs.reading import Run, days_in_words, days_of_both
from postprocess.view.fields import PageField, history_fields, history_names, mesh_measures
from postprocess.view.outlines import packed_outlines
from postprocess.view.packing import packed_rows, quantised
from postprocess.view.palettes import packed_palettes
from swe.diagnostics.outputs import EDGES
from swe.errors import InputError

MOST_VALUES_OF_16_BITS = 6_000_000
"""Pages with more values keep 8 bits of each: with 16, they would have more than 12 MB."""

BITS_OF_THE_MESH = 16

PAGE_SUFFIXES = (".html", ".htm")

SAME_PLACE = 1e-6
"""Generators closer together than this, in radii of the sphere or extents of the plane, are the same."""


def view_page(shown: Run | VoronoiMesh, output: AnyPath, other: Run | None = None, fields: Sequence[str] = ()) -> Path:
    """Write the page of a run, or of two side by side with their difference, to the file `output`; return its path.

    `fields` are those of the history that it shows: by default all but those at edges. A mesh has a page of its own,
    with its measures. Raises `InputError` where there is no such field, where the two runs have different meshes or no
    day in common, where a mesh is to be shown beside a run or with fields of one, and as `require_page` does.
    """
    require_page(output)
    return write_page(page_of(shown, other, fields), output)


def require_page(output: AnyPath) -> None:
    """Raise `InputError` unless a page can be written to `output`, which has a folder and ends in .html or .htm.

    Without such an end, a slip of the hand could replace a file of the run.
    """
    output = Path(output)
    if output.suffix not in PAGE_SUFFIXES:
        raise InputError(f"{output} is no page for a browser; end its name in .html")
    if output.exists() and not output.is_file():
        raise InputError(f"{output} cannot be written, as it exists and is not a file; choose another place")
    if not output.parent.is_dir():
        raise InputError(f"{output} cannot be written: there is no folder {output.parent}; make it first")
    require_possible_folder(output.parent)


def write_page(page: str, output: AnyPath) -> Path:
    """Write the HTML of a page to `output`; return its path. Raises `InputError` as `require_page` does."""
    output = Path(output)
    require_page(output)
    with written_aside(output) as aside:
        aside.write_text(page, encoding="utf-8")
    return output


def page_of(shown: Run | VoronoiMesh, other: Run | None = None, fields: Sequence[str] = ()) -> str:
    """The HTML of the page that `view_page` writes."""
    if isinstance(shown, VoronoiMesh):
        if other is not None or fields:
            raise InputError("a mesh alone has no run beside it and no fields of one; show a run, or the mesh alone")
        return _filled(_content_of_mesh(shown))
    runs = [shown] if other is None else [shown, other]
    if other is not None:
        _require_same_mesh(shown, other)
    return _filled(_content(runs, _names(runs, fields)))


def _filled(content: dict[str, Any]) -> str:
    """The frame of the page with everything in it."""
    parts = files("postprocess.view") / "page"
    frame = (parts / "page.html").read_text(encoding="utf-8")
    # "<" never stands in the data, lest it end the script that holds them.
    filled = {
        "TITLE": escape(content["title"]),
        "HEADING": escape(content["title"]),
        "STYLE": (parts / "page.css").read_text(encoding="utf-8"),
        "DATA": json.dumps(content, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        "PROGRAM": (parts / "page.js").read_text(encoding="utf-8").replace("</script", "<\\/script"),
    }
    return re.sub(r"%([A-Z]+)%", lambda place: filled[place.group(1)], frame)


def _content(runs: Sequence[Run], names: Sequence[str]) -> dict[str, Any]:
    """Everything that the page shows, as `web/src/page.js` reads it."""
    run, mesh = runs[0], runs[0].mesh
    rows = _common_rows(runs)
    # Two runs bring their difference too.
    bits = _bits(run, names, len(rows[0]) * (1 if len(runs) == 1 else 3))
    packed = [_packed_field(fields, rows, bits) for fields in _paired(runs, names)]
    if len(runs) == 1:
        packed += _packed_measures(mesh)
    return {
        "title": f"{' and '.join(each.case for each in runs[: 1 + (runs[-1].case != run.case)])}, {run.cells} cells",
        "panes": [] if len(runs) == 1 else [*(str(each.directory) for each in runs), "difference: first minus second"],
        "days": [float(run.days[row]) for row in rows[0]],
        "mesh": packed_outlines(mesh, {field["place"] for field in packed}),
        "fields": packed,
        "palettes": packed_palettes(),
    }


def _content_of_mesh(mesh: VoronoiMesh) -> dict[str, Any]:
    """The same of a mesh alone, on no days."""
    packed = _packed_measures(mesh)
    return {
        "title": mesh_in_words(mesh),
        "panes": [],
        "days": [],
        "mesh": packed_outlines(mesh, {field["place"] for field in packed}),
        "fields": packed,
        "palettes": packed_palettes(),
    }


def _names(runs: Sequence[Run], chosen: Sequence[str]) -> list[str]:
    """Names of the fields to show; `history_fields` tells of those that are not there."""
    if chosen:
        return list(dict.fromkeys(chosen))
    first, *others = (history_names(run) for run in runs)
    return [name for name, place in first.items() if place != EDGES and all(name in other for other in others)]


def _bits(run: Run, names: Sequence[str], snapshots: int) -> int:
    """Bits of each value where there are so many `snapshots` in all panes; names that are not there do not count."""
    places, mesh = history_names(run), run.mesh
    sizes = {"nCells": mesh.n_cells, "nEdges": mesh.n_edges, "nVertices": mesh.n_vertices}
    count = snapshots * sum(sizes[places[name]] for name in names if name in places)
    return 16 if count <= MOST_VALUES_OF_16_BITS else 8


def _paired(runs: Sequence[Run], names: Sequence[str]) -> Iterator[tuple[PageField, ...]]:
    """Each field of all runs."""
    yield from zip(*(history_fields(run, names) for run in runs), strict=True)


def _packed_field(fields: Sequence[PageField], rows: Sequence[NDArray[np.intp]], bits: int) -> dict[str, Any]:
    """A field of one run, or of two and their difference."""
    field = fields[0]
    values = [_taken(each.values, row) for each, row in zip(fields, rows, strict=False)]
    limits = _limits(*values)
    packed = [_packed_values(each, bits, limits) for each in values]
    if len(values) == 2:
        difference = values[0] - values[1]
        packed.append(_packed_values(difference, bits, _limits(difference)))
    return {
        "name": field.name,
        "meaning": field.meaning,
        "units": field.units,
        "place": field.place,
        "bits": bits,
        "rows": len(values[0]),
        "panes": packed,
    }


def _packed_measures(mesh: VoronoiMesh) -> list[dict[str, Any]]:
    """What is measured of a mesh, which stays the same."""
    first_row = [np.zeros(1, dtype=np.intp)]
    return [_packed_field((field,), first_row, BITS_OF_THE_MESH) for field in mesh_measures(mesh)]


def _taken(values: Array, rows: NDArray[np.intp]) -> Array:
    return values[rows] if len(values) > 1 else values


def _limits(*values: Array) -> tuple[float, float]:
    finite = [each[np.isfinite(each)] for each in values]
    return (
        min((float(each.min()) for each in finite if len(each)), default=0.0),
        max((float(each.max()) for each in finite if len(each)), default=0.0),
    )


def _packed_values(values: Array, bits: int, limits: tuple[float, float]) -> dict[str, Any]:
    whole = quantised(values, bits, limits)
    return {"low": whole.low, "high": whole.high, "values": packed_rows(whole.numbers, bits)}


def _common_rows(runs: Sequence[Run]) -> list[NDArray[np.intp]]:
    """The snapshots of each run, by number, of the days that all have; raise `InputError` where there is none."""
    if len(runs) == 1:
        return [np.arange(len(runs[0].days))]
    first, second = (run.days for run in runs)
    days = days_of_both(first, second)
    if not days:
        raise InputError(
            f"{runs[0].directory} and {runs[1].directory} have no day in common: {days_in_words(first)}; and "
            f"{days_in_words(second)}; run one of them again"
        )
    return [np.array([int(np.argmin(np.abs(run.days - day))) for day in days]) for run in runs]


def _require_same_mesh(run: Run, other: Run) -> None:
    if not _same_cells(run.mesh, other.mesh):
        raise InputError(
            f"{run.directory} and {other.directory} have different meshes ({run.cells} and {other.cells} cells); "
            "a page shows runs side by side on one mesh, trisk compare compares across meshes"
        )


def _same_cells(mesh: VoronoiMesh, other: VoronoiMesh) -> bool:
    if (mesh.n_cells, mesh.n_vertices) != (other.n_cells, other.n_vertices):
        return False
    surface = surface_of(mesh)
    if surface_of(other) != surface:
        return False
    points, others = mesh.cell_points / mesh.length_unit, other.cell_points / other.length_unit
    return bool(np.abs(points - others).max() < SAME_PLACE * surface.extent(points))
