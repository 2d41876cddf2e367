"""One command on several processes: the first speaks for all, and all end together with one exit code."""

import io
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from trisk.processes.launch import Launch

if TYPE_CHECKING:
    from trisk.processes.group import Group

COMMANDS = ("run",)
"""Commands that share their work among processes."""


def run_together(command: Callable[[], None], launch: Launch) -> None:
    """Call `command` on every process, and end all with the exit code of the one of the lowest number that failed.

    `command` exits, with a code, where something goes wrong. Raises `InputError` if mpi4py is missing, or if this is
    no command for several processes.
    """
    said = _speak_for_all(launch)
    group = _joined(launch)
    code = 0
    try:
        command()
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    except BaseException:
        traceback.print_exc()
        code = 1
    code, words = group.end(code, said.getvalue())
    if launch.first and words:
        print(words, file=sys.stderr)
    sys.exit(code)


def _joined(launch: Launch) -> "Group":
    """The group of all processes, once it is clear that they do one thing together."""
    problem = None
    try:
        from trisk.processes.group import Group
    except ImportError:
        problem = (
            f"mpiexec started {launch.size} processes, but they cannot speak with each other, as mpi4py is not "
            "installed; install it (pip install 'trisk[mpi]'), or start trisk without mpiexec"
        )
    else:
        group = Group()
        group.share_processors()
        if not group.has_one_command_line():
            problem = "the processes were started with different arguments; give all of them the same"
        elif group.launch != launch:
            problem = (
                f"mpiexec started {launch.size} processes, but mpi4py knows of {group.launch.size}, as it belongs to "
                "another MPI; install it for the one whose mpiexec this is"
            )
    problem = problem or _problem_with_command(sys.argv[1:])
    if problem:
        from swe.errors import InputError

        raise InputError(problem)
    return group


def _speak_for_all(launch: Launch) -> io.StringIO:
    """Let only the first process write to its streams; returns what the others say of errors meanwhile."""
    said = io.StringIO()
    if not launch.first:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115
        sys.stderr = said
    return said


def _problem_with_command(arguments: Sequence[str]) -> str | None:
    """Why a command cannot be run on several processes, in words; None if it can."""
    named = next((each for each in arguments if not each.startswith("-")), None)
    if named is None or named in COMMANDS:
        return None
    return f"trisk {named} works in one process; start it without mpiexec"
