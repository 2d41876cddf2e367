"""Imports go one way: mesh <- swe <- cases <- postprocess <- trisk."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LAYERS = ["mesh", "swe", "cases", "postprocess", "trisk"]


def imported_packages(source: str) -> set[str]:
    """Packages that a source imports, in any statement, inside functions too, or by name."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("." * node.level + (node.module or ""))
        elif isinstance(node, ast.Call) and called(node) in ("import_module", "__import__", "find_spec"):
            names |= {argument.value for argument in node.args if isinstance(argument, ast.Constant)}
    assert not [name for name in names if name.startswith(".")], "relative imports hide where they lead"
    return {name.split(".")[0] for name in names}


def called(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def against_the_direction(layer: str, source: str) -> set[str]:
    """Packages above `layer`, and the tests, that a source of it imports."""
    return imported_packages(source) & {*LAYERS[LAYERS.index(layer) + 1 :], "tests"}


@pytest.mark.parametrize("layer", LAYERS)
def test_imports_go_one_way(layer: str) -> None:
    files = list((ROOT / layer).rglob("*.py"))
    assert files
    for path in files:
        assert not against_the_direction(layer, path.read_text()), path


@pytest.mark.parametrize(
    "source",
    [
        "import swe",
        "import swe.model as m",
        "from swe.model import State",
        "def f():\n    from swe import State",
        "if TYPE_CHECKING:\n    from swe.state import State",
        "import importlib\nimportlib.import_module('swe.state')",
        "__import__('swe')",
    ],
)
def test_an_import_against_the_direction_is_found(source: str) -> None:
    assert against_the_direction("mesh", source) == {"swe"}
    assert against_the_direction("cases", source) == set()


def test_a_relative_import_is_found() -> None:
    with pytest.raises(AssertionError, match="relative imports"):
        imported_packages("from . import model")


def test_only_files_of_meshes_know_which_arrays_count_from_one() -> None:
    """What asks whether an array holds indices reads or writes them, or says which there are."""
    users = {
        path.relative_to(ROOT).as_posix()
        for layer in LAYERS
        for path in (ROOT / layer).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Attribute) and node.attr == "is_index"
    }
    assert users == {"mesh/io.py", "mesh/mesh_file.py", "mesh/arrange.py"}


def test_version_is_the_same_everywhere() -> None:
    import tomllib

    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"version: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"## {version}" in (ROOT / "CHANGELOG.md").read_text()
