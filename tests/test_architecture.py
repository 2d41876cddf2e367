"""Imports go one way: mesh <- swe <- cases <- postprocess <- trisk, and so do those between the rooms of each."""

import ast
import graphlib
from collections import Counter
from fnmatch import fnmatch
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LAYERS = ["mesh", "swe", "cases", "postprocess", "trisk"]
ROOMS = {
    "mesh": [
        "",
        "geometry",
        "triangulation",
        "density",
        "regions",
        "integrals",
        "discrete",
        "overlap",
        "parts",
        "partition",
        "generation",
        "coast",
        "plane",
        "polygon",
        "files",
    ],
    "swe": ["", "parallel", "equations", "forcing", "tiles", "damping", "diagnostics", "stepping", "output", "run"],
    "cases": ["", "plane", "finding"],
    "postprocess": [
        "",
        "runs",
        "reference",
        "compare",
        "figures",
        "film",
        "view",
        "convert",
        "studies",
        "reports",
        "adaptation",
        "interactive",
    ],
    "trisk": ["processes", "report", "arguments", "cli", "mesh_cli", "results_cli", ""],
}
"""Rooms of each package; one may use those that stand before it. The package itself is the first."""

MOST_MODULES = 12
MOST_LINES = 400


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


def imported_modules(source: str) -> set[str]:
    """Full names of all that statements of import in a source may mean: modules, and what they hold."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def modules_of(layer: str) -> dict[str, Path]:
    """Modules of a package by their full names, but for those that only make a folder a package."""
    files = ((path, path.relative_to(ROOT).with_suffix("")) for path in (ROOT / layer).rglob("*.py"))
    return {".".join(name.parts): path for path, name in files if path.stem != "__init__"}


def room_of(module: str) -> str:
    parts = module.split(".")
    return parts[1] if len(parts) == 3 else ""


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
        "import swe.equations.model as m",
        "from swe.equations.model import State",
        "def f():\n    from swe import State",
        "if TYPE_CHECKING:\n    from swe.state import State",
        "import importlib\nimportlib.import_module('swe.state')",
        "__import__('swe')",
    ],
)
def test_an_import_against_the_direction_is_found(source: str) -> None:
    assert against_the_direction("mesh", source) == {"swe"}
    assert against_the_direction("cases", source) == set()


@pytest.mark.parametrize("layer", LAYERS)
def test_rooms_use_those_before_them(layer: str) -> None:
    modules = modules_of(layer)
    assert {room_of(module) for module in modules} | {""} == set(ROOMS[layer])
    order = {room: number for number, room in enumerate(ROOMS[layer])}
    for module, path in modules.items():
        above = [
            other
            for other in imported_modules(path.read_text()) & modules.keys()
            if order[room_of(other)] > order[room_of(module)]
        ]
        assert not above, module


@pytest.mark.parametrize("layer", LAYERS)
def test_no_module_leads_back_to_itself(layer: str) -> None:
    modules = modules_of(layer)
    uses = {module: imported_modules(path.read_text()) & modules.keys() for module, path in modules.items()}
    list(graphlib.TopologicalSorter(uses).static_order())


def test_a_circle_is_found() -> None:
    with pytest.raises(graphlib.CycleError):
        list(graphlib.TopologicalSorter({"a": {"b"}, "b": {"a"}}).static_order())


@pytest.mark.parametrize("layer", LAYERS)
def test_rooms_are_small(layer: str) -> None:
    counts = Counter(room_of(module) for module in modules_of(layer))
    assert max(counts.values()) <= MOST_MODULES, counts


def test_files_are_short() -> None:
    folders = [ROOT / name for name in (*LAYERS, "tests", "docs")]
    lines = {path: len(path.read_text().splitlines()) for folder in folders for path in folder.rglob("*.py")}
    assert len(lines) > 200
    assert {path: count for path, count in lines.items() if count > MOST_LINES} == {}


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
    assert users == {"mesh/files/io.py", "mesh/files/mesh_file.py", "mesh/files/arrange.py"}


def test_what_only_makes_pages_is_not_installed() -> None:
    import tomllib

    included = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]["find"]["include"]
    folders = [path.name for path in ROOT.iterdir() if path.is_dir() and path.suffix != ".egg-info"]
    assert {name for name in folders for pattern in included if fnmatch(name, pattern)} == set(LAYERS)
    tools = {path.stem for path in (ROOT / "docs" / "tools").glob("*.py")}
    assert tools
    for layer in LAYERS:
        for path in (ROOT / layer).rglob("*.py"):
            assert not imported_packages(path.read_text()) & tools, path


def test_version_is_the_same_everywhere() -> None:
    import tomllib

    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert f"version: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"## {version}" in (ROOT / "CHANGELOG.md").read_text()
