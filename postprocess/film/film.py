"""Films of a run: one field over its snapshots."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib import font_manager
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from PIL import Image, ImageDraw, ImageFont

from mesh.arrays import Array, Index
from mesh.safe_files import AnyPath, dataset
from postprocess.figures.field_map import MIDDLE, Projection, drawing_of, plot_field
from postprocess.figures.palettes import colours_for
from postprocess.figures.shown_fields import ShownField, changing_fields, snapshot_field
from postprocess.film.film_file import require_kind, write_film
from postprocess.film.stencil import Pixels, Stencil, stencil_of
from postprocess.runs.reading import Progress, Run, days_in_words
from swe.errors import InputError
from swe.output.files import HISTORY_FILE

SIZE = (1280, 720)
DOTS_PER_INCH = 100.0
SMALLEST, LARGEST = 160, 8192
"""Pixels of a side: fewer have no room for the colour bar, and more are beyond H.264."""

LEAST_SECONDS = 8.0
FEWEST_FRAMES_PER_SECOND, MOST_FRAMES_PER_SECOND = 4.0, 25.0
"""Films of few snapshots last `LEAST_SECONDS`, unless that would be a jerk for each; those of many run smoothly."""

LETTERS = 1.0 / 36.0
"""Height of the day's letters, of that of the film."""


def film(
    run: Run,
    field: str,
    path: AnyPath,
    *,
    days: tuple[float, float] | None = None,
    size: tuple[int, int] = SIZE,
    projection: Projection | None = None,
    centre: tuple[float, float] = MIDDLE,
    progress: Progress = lambda what, part: None,
) -> Path:
    """Write a film of a field at cells, edges or vertices, a frame for each snapshot; return its path.

    The name's end, .mp4 or .gif, says the kind. `days` are the first and the last day, by default all. `size` is the
    width and height in pixels; `projection` and `centre` are those of `plot_field`, which do not go with planes.
    Colours run over all values of the field on these days. `progress` is called with the part that is done.

    Raises `InputError` where there is no such field, map, kind of film or size, values are damaged, or there are fewer
    than two snapshots.
    """
    path = Path(path)
    _require_size(size)
    require_kind(path, size)
    drawing_of(run.mesh, centre, None, None, projection)  # refused before all values are read
    rows = _rows(run, days)
    _require_in_time(run, field)
    shown = snapshot_field(run, field, int(rows[0]))
    colours = ScalarMappable(**colours_for(field, _extremes(run, field, rows, progress)).options)
    stencil = _stencil(run, shown, colours, size, projection, centre)
    frames = _frames(run, field, rows, stencil, colours, progress)
    write_film(
        path, frames, size, _frames_per_second(len(rows)), colours.cmap(np.linspace(0.0, 1.0, 256), bytes=True)[:, :3]
    )
    return path


def _require_size(size: tuple[int, int]) -> None:
    if not all(SMALLEST <= side <= LARGEST for side in size):
        raise InputError(
            f"a film cannot have {size[0]} x {size[1]} pixels; give each side {SMALLEST} to {LARGEST} of them"
        )


def _rows(run: Run, days: tuple[float, float] | None) -> Index:
    """Numbers of the snapshots from the first to the last of `days`."""
    first, last = days or (run.days[0], run.days[-1])
    rows = run.numbers_between(first, last)
    if len(rows) < 2:
        raise InputError(
            f"{run.directory} has {len(rows)} snapshot{'' if len(rows) == 1 else 's'} from day {first:g} to day "
            f"{last:g}, and a film needs two; its days are {days_in_words(run.days)}"
        )
    return rows


def _require_in_time(run: Run, field: str) -> None:
    path = run.directory / HISTORY_FILE
    with dataset(path) as file:
        changing = changing_fields(file)
    if field not in changing:
        raise InputError(f"{path} has no field '{field}' that changes in time; choose among {', '.join(changing)}")


def _extremes(run: Run, field: str, rows: Index, progress: Progress) -> Array:
    """The least and the largest value (n_rows, 2) of each snapshot."""
    extremes = np.empty((len(rows), 2))
    for done, row in enumerate(rows):
        values = run.field(field, int(row))
        extremes[done] = values.min(), values.max()
        progress("range of colours", (done + 1) / len(rows))
    return extremes


def _stencil(
    run: Run,
    shown: ShownField,
    colours: ScalarMappable,
    size: tuple[int, int],
    projection: Projection | None,
    centre: tuple[float, float],
) -> Stencil:
    """The map of the field with its colour bar and title, and room for the day."""
    inches = size[0] / DOTS_PER_INCH, size[1] / DOTS_PER_INCH
    figure = Figure(figsize=inches, dpi=DOTS_PER_INCH, layout="constrained")
    axes = figure.subplots()
    numbers = np.arange(len(shown.values), dtype=float)
    plot_field(run.mesh, numbers, axes, projection=projection, centre=centre, colour_bar=False)
    axes.set_title(f"{run.case}, {run.cells} cells")
    figure.colorbar(colours, ax=axes, shrink=0.8, label=shown.label)
    return stencil_of(axes)


def _frames(
    run: Run,
    field: str,
    rows: Index,
    stencil: Stencil,
    colours: ScalarMappable,
    progress: Progress,
) -> Iterator[Pixels]:
    height = stencil.shown.shape[0]
    font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), max(10, round(LETTERS * height)))
    digits = _decimals(run.days[rows])
    for done, row in enumerate(rows):
        image = Image.fromarray(stencil.picture(colours.to_rgba(run.field(field, int(row)), bytes=True)[:, :3]))
        place = (0.5 * font.size, 0.4 * font.size)
        ImageDraw.Draw(image).text(place, f"day {run.days[row]:.{digits}f}", fill="black", font=font)
        yield np.asarray(image)
        progress("frames", (done + 1) / len(rows))


def _decimals(days: Array) -> int:
    """Decimals that tell all days, so that the number does not change its width."""
    return next((digits for digits in range(3) if np.allclose(np.round(days, digits), days, atol=1e-6)), 3)


def _frames_per_second(count: int) -> float:
    return float(np.clip(count / LEAST_SECONDS, FEWEST_FRAMES_PER_SECOND, MOST_FRAMES_PER_SECOND))
