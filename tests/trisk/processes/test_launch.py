"""What launchers say in the environment."""

import ast
from pathlib import Path

import pytest

from trisk.processes.launch import Launch, launch_of

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("environment", "launch"),
    [
        ({}, Launch(0, 1)),
        ({"PMI_RANK": "2", "PMI_SIZE": "3"}, Launch(2, 3)),
        ({"OMPI_COMM_WORLD_RANK": "0", "OMPI_COMM_WORLD_SIZE": "4"}, Launch(0, 4)),
        ({"PMI_RANK": "2"}, Launch(0, 1)),
        ({"PMI_RANK": "two", "PMI_SIZE": "three"}, Launch(0, 1)),
    ],
)
def test_launchers_are_known(environment: dict[str, str], launch: Launch) -> None:
    assert launch_of(environment) == launch


def test_the_first_speaks() -> None:
    assert [Launch(rank, 3).first for rank in range(3)] == [True, False, False]


def importers(name: str) -> set[str]:
    """Modules of ours that import `name`, or a module of it, when they are loaded."""
    found = set()
    for package in ("mesh", "swe", "cases", "postprocess", "trisk"):
        for path in (ROOT / package).rglob("*.py"):
            for node in ast.parse(path.read_text()).body:
                names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
                names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                if any(each == name or each.startswith(f"{name}.") for each in names):
                    found.add(".".join(path.relative_to(ROOT).with_suffix("").parts))
    return found


def test_a_command_on_one_process_never_loads_mpi() -> None:
    """What needs mpi4py is loaded within functions, which are called under mpiexec alone."""
    need = importers("mpi4py")
    assert need == {"swe.parallel.mpi", "swe.parallel.agreement", "swe.parallel.sharing", "trisk.processes.group"}
    assert set().union(*(importers(module) for module in need)) <= need
