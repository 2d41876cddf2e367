"""One HTML page that holds tables and figures and needs no other file; the figures are written as PNG too."""

import base64
import html
import io
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from mesh.safe_files import written_aside
from postprocess.studies.lines import schemes_of, to_be_named
from postprocess.studies.study_folder import StudyRow

REPORT_FILE = "report.html"
FIGURES_FOLDER = "figures"
REPORT_DOTS_PER_INCH = 100

STYLE = """
body { font-family: sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; font-size: 85%; }
th, td { padding: .25em .7em; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
.wide { overflow-x: auto; }
img { max-width: 100%; }
"""

Columns = Mapping[str, str]
"""Columns of the rows and what stands above it, in order."""


def table_of(rows: Sequence[StudyRow], columns: Columns) -> str:
    """An HTML table of those columns that any row has; schemes where they are to be named, beside the first column."""
    if to_be_named(schemes_of(rows)):
        first, *others = columns.items()
        columns = dict([first, ("scheme", "scheme"), *others])
    shown = {name: title for name, title in columns.items() if any(row.get(name, "") != "" for row in rows)}
    head = "".join(f"<th>{html.escape(title)}</th>" for title in shown.values())
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(_in_words(row.get(name, '')))}</td>" for name in shown) + "</tr>\n"
        for row in rows
    )
    return f'<div class="wide"><table>\n<tr>{head}</tr>\n{body}</table></div>'


def _in_words(value: float | str) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write_page(
    folder: Path,
    title: str,
    text: str,
    arguments: Sequence[str],
    sections: Mapping[str, str],
    figures: Mapping[str, Figure],
) -> Path:
    """Write the page of a study, with each figure as PNG beside it, and return its path.

    `text` stands first, then the command of these `arguments`; `sections` are tables by their headings, `figures` go by
    the names of their files.
    """
    (folder / FIGURES_FOLDER).mkdir(exist_ok=True)
    parts = [f"<h1>{html.escape(title)}</h1>\n<p>{html.escape(text)}</p>"]
    parts.append(f"<p>Made by <code>{html.escape(shlex.join(arguments))}</code></p>")
    parts += [f"<h2>{html.escape(name)}</h2>\n{table}" for name, table in sections.items()]
    for name, figure in figures.items():
        image = _png(figure)
        with written_aside(folder / FIGURES_FOLDER / f"{name}.png") as aside:
            aside.write_bytes(image)
        source = f"data:image/png;base64,{base64.b64encode(image).decode()}"
        parts.append(f'<p><img src="{source}" alt="{html.escape(name)}"></p>')
    path = folder / REPORT_FILE
    start = f'<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>'
    with written_aside(path) as aside:
        aside.write_text(
            f"{start}\n<style>{STYLE}</style>\n" + "\n".join(parts) + "\n</html>\n", "utf-8", "backslashreplace"
        )
    return path


def _png(figure: Figure) -> bytes:
    """The figure as PNG with a palette, a third of the size of one in true colour."""
    full, small = io.BytesIO(), io.BytesIO()
    figure.savefig(full, dpi=REPORT_DOTS_PER_INCH, format="png")
    Image.open(full).convert("RGB").quantize(256).save(small, format="PNG", optimize=True)
    return small.getvalue()
