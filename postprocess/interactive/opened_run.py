"""The run that `open_run` gives to users: files read on first use, and maps of its fields."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mesh.arrays import Array
from mesh.safe_files import AnyPath
from postprocess.runs.reading import Run, open_as

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from postprocess.interactive.page import Page


@dataclass(frozen=True, eq=False, repr=False)
class OpenedRun(Run):
    """A run that draws and shows itself; see `postprocess.runs.reading.Run` for what it holds."""

    def plot(
        self,
        field: str | Array,
        day: float | None = None,
        ax: "Axes | None" = None,
        *,
        region: tuple[float, float, float, float] | None = None,
        **options: Any,
    ) -> "Axes":
        """Draw a field on a map, on `day`, by default the last; return the Axes that it is drawn on.

        `field` is the name of a field at cells, edges or vertices, or values there, also a row for each snapshot, such
        as differences of two runs. `region` is (west, east, south, north) in degrees; `ax` and the other `options` are
        those of `postprocess.plot_field`. Raises `InputError` where there is no such field, day or region.
        """
        from postprocess.figures.field_map import plot_field  # only here: reading a run needs no matplotlib

        time = -1 if day is None else self.number_of(day)
        return plot_field(self, field, ax, time=time, region=region, **options)

    def view(self, other: Run | None = None, *, fields: str | Sequence[str] = ()) -> "Page":
        """The page with the globe that `trisk view` writes; a notebook shows it, and `save` writes it to a file.

        With an `other` run on the same mesh it shows both and their difference. `fields` is one of the history or
        several, by default all but those at edges. Raises `InputError` as `postprocess.view.view_page` does.
        """
        from postprocess.interactive.page import Page
        from postprocess.view import page_of

        return Page(page_of(self, other, [fields] if isinstance(fields, str) else fields), self.directory.name)


def open_run(directory: AnyPath) -> OpenedRun:
    """Open the directory of a run that has finished or is still going; raise `InputError` if it holds no run.

    Mesh, fields and diagnostics are read and checked on first use.
    """
    return open_as(OpenedRun, directory)
