"""Commands under mpiexec, of which no process is left behind."""

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MPIEXEC = shutil.which("mpiexec", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
MARK = "TRISK_TEST_MARK"

needs_mpi = pytest.mark.skipif(
    MPIEXEC is None or importlib.util.find_spec("mpi4py") is None,
    reason="mpi4py or mpiexec is not installed; pip install 'trisk[mpi]' brings both",
)


class Started:
    """A command on some processes, with one thread each unless `environment` says otherwise; use it as a context."""

    def __init__(self, count: int, command: list[object], environment: Mapping[str, str] | None = None) -> None:
        assert MPIEXEC is not None
        self._mark = uuid.uuid4().hex
        known = {**os.environ, "NUMBA_NUM_THREADS": "1", "PYTHONPATH": str(ROOT), **(environment or {})}
        self.program = subprocess.Popen(
            [MPIEXEC, "-n", str(count), *map(str, command)],
            env={**known, MARK: self._mark},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def __enter__(self) -> "Started":
        return self

    def __exit__(self, *_: object) -> None:
        for process in [-self.program.pid, *self.left()]:
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                continue
        self.program.wait()

    def end(self, timeout: float = 400.0) -> tuple[int, str]:
        """Wait for the end; exit code and output. No process may be left a moment later."""
        output, _ = self.program.communicate(timeout=timeout)
        wait_until(lambda: not self.left(), 10.0)
        return self.program.returncode, output

    def workers(self) -> list[int]:
        """The Python processes, where the system tells."""
        return [process for process in self.left() if "python" in os.readlink(f"/proc/{process}/exe")]

    def left(self) -> list[int]:
        """Processes that are there, with mpiexec and its helpers."""
        found = []
        for path in Path("/proc").glob("[0-9]*/environ"):
            try:
                if self._mark.encode() in path.read_bytes():
                    found.append(int(path.parent.name))
            except OSError:  # the process has ended, or is none of ours
                continue
        return found


def on_processes(count: int, command: list[object], environment: Mapping[str, str] | None = None) -> tuple[int, str]:
    """Exit code and output of a command on some processes."""
    with Started(count, command, environment) as started:
        return started.end()


def wait_until(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    """Wait until the condition holds; fail if it does not in so many `seconds`."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.02)
