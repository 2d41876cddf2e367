"""A page that a notebook shows in a frame."""

from dataclasses import dataclass
from html import escape
from pathlib import Path

from mesh.safe_files import AnyPath
from postprocess.view import write_page

HEIGHT = 720
"""Of the frame, in pixels."""


@dataclass(frozen=True, eq=False, repr=False)
class Page:
    """HTML that needs nothing else, and a short name of what it shows."""

    html: str
    name: str

    def save(self, path: AnyPath) -> Path:
        """Write the page to a file, .html; return its path. Raises `InputError` as `postprocess.view.require_page`."""
        return write_page(self.html, path)

    def __repr__(self) -> str:
        return f"<Page of {self.name}, {len(self.html) / 1e6:.1f} MB; a notebook shows it, and save(path) writes it>"

    def _repr_html_(self) -> str:
        source = escape(self.html, quote=True)
        return f'<iframe srcdoc="{source}" style="width: 100%; height: {HEIGHT}px; border: 0"></iframe>'
