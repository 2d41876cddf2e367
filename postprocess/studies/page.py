"""One HTML page of findings, figures and tables that needs no other file; the figures are written as PNG too."""

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
body { font-family: sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; color: #222; line-height: 1.4; }
h1, h2, p, li, figcaption, code { overflow-wrap: anywhere; }
.verdict { border-left: .3em solid #4878a8; padding: .1em 1.2em; background: #f3f6fa; }
.verdict h3 { margin: .8em 0 .2em; font-size: 105%; }
.verdict p { margin: .2em 0 .3em; }
.verdict { padding-bottom: .6em; }
figure { margin: 2em 0; }
figcaption { margin-top: .4em; color: #444; }
table { border-collapse: collapse; margin: 1em 0; font-size: 85%; }
th, td { padding: .25em .7em; border-bottom: 1px solid #ddd; text-align: right; vertical-align: bottom; }
th:first-child, td:first-child, td.words { text-align: left; }
td { white-space: nowrap; }
td.words { white-space: normal; overflow-wrap: anywhere; }
img { max-width: 100%; }
"""

KEYS = ("family", "scheme", "cells", "name", "run", "day", "time_step_s")
"""Columns that say what a row is of: those that lead a table stand again at the start of each of its parts."""

PAGE_WIDTH = 940.0
"""Pixels that a table may take: it then fits a page of 1000."""

LETTER, PADDING = 8.7, 20.0
"""Widths of a letter of a wide font and of the space about a column, pixels."""

LONG_WORDS = 30
"""Text of more letters than this is wrapped."""

Columns = Mapping[str, str]
"""Columns of the rows and what stands above it, in order."""


def table_of(rows: Sequence[StudyRow], columns: Columns) -> str:
    """An HTML table of those columns that any row has; schemes where they are to be named, beside the first column.

    A table that would be wider than the page comes in parts, one below the other. Empty if there is nothing to show.
    """
    if to_be_named(schemes_of(rows)):
        first, *others = columns.items()
        columns = dict([first, ("scheme", "scheme"), *others])
    shown = {name: title for name, title in columns.items() if any(row.get(name, "") != "" for row in rows)}
    return "\n".join(_table(rows, part) for part in _parts(rows, shown))


def _parts(rows: Sequence[StudyRow], columns: Columns) -> list[Columns]:
    """The columns in parts that fit the page, each with those that say what a row is of."""
    names = list(columns)
    leading = next((place for place, name in enumerate(names) if name not in KEYS), len(names)) or 1
    keys, parts, used = names[:leading], [names[:leading]], 0.0
    for name in names[leading:]:
        width = _width(rows, name, columns[name])
        if used and used + width > PAGE_WIDTH - sum(_width(rows, key, columns[key]) for key in keys):
            parts.append(list(keys))
            used = 0.0
        parts[-1].append(name)
        used += width
    return [{name: columns[name] for name in part} for part in parts if part]


def _width(rows: Sequence[StudyRow], name: str, title: str) -> float:
    """Pixels that a column takes: headings wrap between words, and so do long texts."""
    letters = max(min(len(_in_words(row.get(name, ""))), LONG_WORDS) for row in rows)
    return LETTER * max(letters, *map(len, title.split())) + PADDING


def _table(rows: Sequence[StudyRow], columns: Columns) -> str:
    head = "".join(f"<th>{html.escape(title)}</th>" for title in columns.values())
    body = "".join("<tr>" + "".join(_cell(row.get(name, "")) for name in columns) + "</tr>\n" for row in rows)
    return f"<table>\n<tr>{head}</tr>\n{body}</table>"


def _cell(value: float | str) -> str:
    words = _in_words(value)
    start = '<td class="words">' if len(words) > LONG_WORDS else "<td>"
    return f"{start}{html.escape(words)}</td>"


def _in_words(value: float | str) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def write_page(
    folder: Path,
    title: str,
    text: str,
    arguments: Sequence[str],
    sections: Mapping[str, str],
    figures: Mapping[str, Figure],
    verdict: Mapping[str, Sequence[str]] | None = None,
    captions: Mapping[str, str] | None = None,
) -> Path:
    """Write the page of a study, with each figure as PNG beside it, and return its path.

    `figures` go by the names of their files; all else is as `write_pictures` has it.
    """
    (folder / FIGURES_FOLDER).mkdir(exist_ok=True)
    pictures = {}
    for name, figure in figures.items():
        pictures[name] = _png(figure)
        with written_aside(folder / FIGURES_FOLDER / f"{name}.png") as aside:
            aside.write_bytes(pictures[name])
    return write_pictures(folder, title, text, arguments, sections, pictures, verdict, captions)


def write_pictures(
    folder: Path,
    title: str,
    text: str,
    arguments: Sequence[str],
    sections: Mapping[str, str],
    pictures: Mapping[str, bytes],
    verdict: Mapping[str, Sequence[str]] | None = None,
    captions: Mapping[str, str] | None = None,
) -> Path:
    """Write the page with `pictures`, PNG by name, and return its path.

    What was found stands first, the `verdict`: sentences by the question that they answer. Then come `text` and the
    command of these `arguments`, the pictures with their `captions` by name, and `sections`, tables by their headings.
    """
    parts = [f"<h1>{html.escape(title)}</h1>", *_findings(verdict or {}), f"<p>{html.escape(text)}</p>"]
    parts.append(f"<p>Made by <code>{html.escape(shlex.join(arguments))}</code></p>")
    parts += [_pictured(name, image, (captions or {}).get(name, "")) for name, image in pictures.items()]
    parts += [f"<h2>{html.escape(name)}</h2>\n{table}" for name, table in sections.items() if table]
    path = folder / REPORT_FILE
    start = f'<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>'
    with written_aside(path) as aside:
        aside.write_text(
            f"{start}\n<style>{STYLE}</style>\n" + "\n".join(parts) + "\n</html>\n", "utf-8", "backslashreplace"
        )
    return path


def _findings(verdict: Mapping[str, Sequence[str]]) -> list[str]:
    """The verdict in a frame; nothing if there is none."""
    found = [
        f"<h3>{html.escape(question)}</h3>\n{' '.join(f'<p>{html.escape(sentence)}</p>' for sentence in sentences)}"
        for question, sentences in verdict.items()
        if sentences
    ]
    return ['<div class="verdict">', *found, "</div>"] if found else []


def _pictured(name: str, image: bytes, caption: str) -> str:
    source = f"data:image/png;base64,{base64.b64encode(image).decode()}"
    below = f"\n<figcaption>{html.escape(caption)}</figcaption>" if caption else ""
    return f'<figure><img src="{source}" alt="{html.escape(name)}">{below}</figure>'


def _png(figure: Figure) -> bytes:
    """The figure as PNG with a palette."""
    full = io.BytesIO()
    figure.savefig(full, dpi=REPORT_DOTS_PER_INCH, format="png")
    return with_palette(full.getvalue())


def at_page_size(image: bytes, dots_per_inch: float) -> bytes:
    """A PNG of so many dots per inch with as many as the page has, in all its colours."""
    full, small = Image.open(io.BytesIO(image)).convert("RGB"), io.BytesIO()
    width, height = (round(length * REPORT_DOTS_PER_INCH / dots_per_inch) for length in full.size)
    full.resize((width, height), Image.Resampling.LANCZOS).save(small, format="PNG", optimize=True)
    return small.getvalue()


def with_palette(image: bytes) -> bytes:
    """A PNG with a palette, a third of the size of one in true colour."""
    small = io.BytesIO()
    Image.open(io.BytesIO(image)).convert("RGB").quantize(256).save(small, format="PNG", optimize=True)
    return small.getvalue()
