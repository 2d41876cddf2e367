"""Configuration of the documentation site, which `make docs` builds with sphinx in docs/_build."""

from importlib.metadata import version as version_of
from typing import Any

from docutils import nodes
from math_core import LatexToMathML
from sphinx.application import Sphinx

project = "trisk"
author = "The trisk authors"
project_copyright = author
release = version = version_of("trisk")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "gallery", "tools", "templates", "sg_execution_times.rst"]
templates_path = ["templates"]

myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 4
myst_url_schemes = ["http", "https"]

default_role = "py:obj"  # names between backticks in docstrings lead to their pages where these exist
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # signatures would spell out every type of an array; docstrings say shape and units
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "capture_repr": (),  # what is printed is shown, what a last line returns is not
    "show_signature": False,
}

html_theme = "pydata_sphinx_theme"
html_title = "trisk"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_sourcelink = False
html_theme_options = {
    "show_prev_next": False,
    "secondary_sidebar_items": ["page-toc", "sg_download_links"],
    "footer_start": ["copyright"],
    "footer_end": [],
}


def begin_with_a_comment(_app: Sphinx, what: str, _name: str, _obj: object, _options: Any, lines: list[str]) -> None:
    """Keep napoleon from taking what stands before a colon in the first line of an attribute for its type."""
    if what in ("attribute", "property"):
        lines[:0] = ["..", ""]


def setup(app: Sphinx) -> None:
    """Let equations be MathML, which browsers draw themselves: no script, and no network to fetch one from."""
    app.connect("autodoc-process-docstring", begin_with_a_comment, priority=1)
    converter = LatexToMathML()

    def open_equation(translator: Any, node: nodes.math | nodes.math_block) -> None:
        block = isinstance(node, nodes.math_block)
        equation = converter.convert_with_local_state(node.astext(), displaystyle=block)
        translator.body.append(f'<div class="equation">{equation}</div>' if block else equation)
        raise nodes.SkipNode

    app.add_html_math_renderer("mathml", (open_equation, None), (open_equation, None))
