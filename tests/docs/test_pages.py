"""The pages of the documentation site: links, table of contents, public names, programs of the gallery."""

import ast
import re
from fnmatch import fnmatch
from pathlib import Path

import pytest

import trisk

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.glob("*.md"), DOCS / "meshes" / "README.md", DOCS / "api" / "index.md"])
PROGRAMS = sorted((DOCS / "gallery").glob("*.py"))

FENCED = re.compile(r"^(```+|:::+).*?^\1", re.MULTILINE | re.DOTALL)
TABLE_OF_CONTENTS = re.compile(r"^```\{toctree\}\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")


def entries(page: Path) -> list[str]:
    """What the tables of contents of a page list."""
    lines = "\n".join(TABLE_OF_CONTENTS.findall(page.read_text())).splitlines()
    return [line for line in lines if line and not line.startswith(":")]


def anchors(page: Path) -> set[str]:
    """Anchors of the headings, as sites and code forges make them."""
    headings = re.findall(r"^#+ (.*)$", FENCED.sub("", page.read_text()), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_every_page_is_in_the_table_of_contents_once() -> None:
    listed = [*entries(DOCS / "index.md"), *entries(DOCS / "guide.md")]
    named = [entry for entry in listed if "*" not in entry]
    assert len(set(named)) == len(named)
    patterns = [entry for entry in listed if "*" in entry]
    for page in PAGES:
        name = page.relative_to(DOCS).with_suffix("").as_posix()
        assert name == "index" or name in named or any(fnmatch(name, pattern) for pattern in patterns), name
    generated = {"examples/index"}
    for name in named:
        assert name in generated or (DOCS / f"{name}.md").exists(), name


@pytest.mark.parametrize("page", [ROOT / "README.md", *PAGES], ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files_and_headings(page: Path) -> None:
    for target in LINK.findall(page.read_text()):
        if "://" in target:
            continue
        path, _, anchor = target.partition("#")
        file = page.parent / path if path else page
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target


def test_public_names_have_pages_under_their_packages() -> None:
    sections = re.split(r"^## ", (DOCS / "api" / "index.md").read_text(), flags=re.MULTILINE)[1:]
    for section in sections:
        package = re.search(r"\(`(\w+)`\)", section)
        assert package is not None
        listed = re.findall(r"^   (\w+)$", section, re.MULTILINE)
        dictionaries = re.findall(r"`([A-Z_]+)`", section)
        assert sorted({*listed, *dictionaries}) == sorted(trisk._PLACES[package[1]])
    assert len(sections) == len(trisk._PLACES)


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.stem)
def test_programs_of_the_gallery_compile_and_have_a_title(program: Path) -> None:
    source = program.read_text()
    tree = ast.parse(source)
    compile(tree, program, "exec")
    title, underline, *text = (ast.get_docstring(tree) or "").splitlines()
    assert underline == "=" * len(title)
    assert any(text)
    assert "plt.show" not in source
    imported = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert any(alias.name == "trisk" for node in imported for alias in node.names)


def test_the_gallery_has_at_least_eight_programs() -> None:
    assert len(PROGRAMS) >= 8
