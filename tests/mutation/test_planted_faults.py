"""The tool that plants faults, on small sources."""

import ast
from pathlib import Path

import pytest
from mutants import importers, reaching_tests, report
from mutations import draw, mutations

ROOT = Path(__file__).resolve().parents[2]
SOURCE = b'''"""Prose."""

UNITS = "m s-1"

def speed(u: float = 0.5, n: int = 3) -> float:
    """Prose."""
    if u < 0.0:
        raise ValueError(f"speed is {u + 1} m/s")
    return -u * scale(u, n)
'''


def planted(source: bytes) -> set[tuple[int, str, str]]:
    """Line, kind and new text of all mutations of a source."""
    return {(mutation.line, mutation.kind, mutation.new) for mutation in mutations("a.py", source)}


def test_every_kind_of_fault_is_planted() -> None:
    assert planted(SOURCE) >= {
        (3, "text", "'m'"),
        (5, "constant", "1.0"),
        (5, "constant", "4"),
        (7, "comparison", "<="),
        (7, "comparison", ">"),
        (8, "operator", "-"),
        (9, "sign", "u"),
        (9, "operator", "/"),
        (9, "arguments", "n, u"),
    }


def test_prose_and_types_are_left_alone() -> None:
    assert not {new for _, kind, new in planted(SOURCE) if kind == "text"} - {"'m'"}
    assert planted(b"def f(x: 'float') -> None:\n    'Prose.'\n    warn('too long a word')\n") == {
        (3, "statement", "pass")
    }


def test_a_mutant_differs_in_one_place(tmp_path: Path) -> None:
    for mutation in mutations("a.py", SOURCE):
        (tmp_path / "a.py").write_bytes(SOURCE)
        mutation.apply(tmp_path)
        mutant = (tmp_path / "a.py").read_bytes()
        assert ast.dump(ast.parse(mutant)) != ast.dump(ast.parse(SOURCE))
        assert mutant[: mutation.start] == SOURCE[: mutation.start]
        assert mutant.endswith(SOURCE[mutation.stop :])


@pytest.mark.slow
def test_the_seed_decides_what_is_drawn() -> None:
    first = draw(ROOT, 30, seed=1)
    assert first == draw(ROOT, 30, seed=1)
    assert first != draw(ROOT, 30, seed=2)
    assert len({mutation.name for mutation in first}) == 30
    assert len({mutation.path.split("/")[0] for mutation in first}) >= 3


def test_tests_that_reach_a_line_are_found() -> None:
    inside = next(mutation for mutation in mutations("a.py", SOURCE) if mutation.line == 9)
    known = {
        "fixtures": {"test_b.py::one": [], "test_a.py::two": ["mesh"], "test_c.py::three": [], "test_d.py::four": []},
        "seconds": {"test_b.py::one": 1.0, "test_a.py::two": 9.0, "test_c.py::three": 0.1},
        "lines": {
            "test_b.py::one": {"a.py": [9]},
            "fixture mesh": {"a.py": [9]},
            "test_c.py::three": {"a.py": [9]},
            "test_d.py::four": {"a.py": [7]},
        },
    }
    assert reaching_tests(ROOT, inside, known) == ["test_a.py::two", "test_c.py::three", "test_b.py::one"]
    untraced = {"fixtures": {"test_a.py::five": [], "test_b.py::one": []}, "seconds": {}, "lines": {}}
    assert reaching_tests(ROOT, inside, untraced) == ["test_a.py::five"]
    at_import = next(mutation for mutation in mutations("a.py", SOURCE) if mutation.line == 3)
    assert "test_d.py::four" in reaching_tests(ROOT, at_import, known)


def test_importers_are_found() -> None:
    found = importers(ROOT, "mesh/geometry/sphere.py")
    assert found >= {"mesh/geometry/sphere.py", "mesh/discrete/metrics.py", "mesh/density/named.py"}
    assert "mesh/arrays.py" not in found


@pytest.mark.parametrize(("verdict", "killed"), [("killed", 1), ("killed by time", 1), ("survived", 0)])
def test_report_counts_by_file(verdict: str, killed: int) -> None:
    text = report({"a.py:3:1-2:x": {"path": "a.py", "kind": "text", "verdict": verdict, "shown": "a -> b"}})
    assert f"{killed} of 1 mutants killed" in text
    assert f"a.py: {killed} of 1" in text
    assert ("a -> b" in text) == (not killed)
