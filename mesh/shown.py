"""How objects show themselves: a title and a few rows, as text for `repr` and as a table for notebooks."""

import html
import reprlib
from collections.abc import Mapping

import numpy as np

from mesh.arrays import Array
from mesh.plain import plain

Rows = dict[str, str]
"""What is told, by its name; each fits in a line, and where there is nothing to tell it is empty."""

LONGEST = 80
"""Number of characters of a text that is told."""

KILOMETRE = 1000.0
"""In metres."""

LEFT = 'style="text-align: left"'
"""No colours: those of the notebook, dark or light, are right."""


class Shown:
    """Derive from it and tell title and rows: `repr` gives them as text, notebooks as a table."""

    def _title_and_rows(self) -> tuple[str, Rows]:
        """What it is, and what one wants to know of it; must be quick, whatever the size of arrays."""
        raise NotImplementedError(f"{type(self).__name__} has no title and rows to show")

    def __repr__(self) -> str:
        return as_text(*self._title_and_rows())

    def _repr_html_(self) -> str:
        return as_html(*self._title_and_rows())


def as_text(title: str, rows: Mapping[str, str]) -> str:
    """The title and, below it, one line for each row; rows without words are left out."""
    return "<" + "\n  ".join([title, *(f"{name}: {value}" for name, value in rows.items() if value)]) + ">"


def as_html(title: str, rows: Mapping[str, str]) -> str:
    """The same as a table in HTML; what the words hold is escaped."""
    lines = "".join(
        f'<tr><th scope="row" {LEFT}>{html.escape(name)}</th><td {LEFT}>{html.escape(value)}</td></tr>'
        for name, value in rows.items()
        if value
    )
    return f"<div><strong>{html.escape(title)}</strong><table><tbody>{lines}</tbody></table></div>"


def in_words(value: object, units: str = "") -> str:
    """A value of any type in a few words: numbers with their units, functions by name, the shape alone of arrays."""
    value = plain(value)
    if isinstance(value, float):
        text = f"{value:.10g}"
    elif isinstance(value, np.ndarray):
        text = f"array of shape {value.shape}"
    elif callable(value):
        text = str(getattr(value, "__qualname__", type(value).__name__))
    else:
        text = str(value) if isinstance(value, str | int) or value is None else reprlib.repr(value)
    line = " ".join(text.split())
    shown = line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."
    return f"{shown} {units}" if units else shown


def span(values: Array, units: str) -> str:
    """The range of an array in words: "50 to 200 m"."""
    if not values.size:
        return "no values"
    least, largest = values.min(), values.max()
    return f"{least:g} {units}" if least == largest else f"{least:g} to {largest:g} {units}"


def in_kilometres(metres: float) -> str:
    """A length in words, in metres if it is short."""
    return f"{metres:.4g} m" if metres < KILOMETRE else f"{metres / KILOMETRE:.6g} km"
