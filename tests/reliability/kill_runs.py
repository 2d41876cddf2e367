"""Runs killed at random moments and gone on with: python tests/reliability/kill_runs.py KILLS [SEED].

Every run writes snapshots, rows and checkpoints at almost every step, so that many kills fall into a writing. Prints a
line for each kill, and exits with 1 unless all files equal those of a run without a stop.
"""

import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

RUN = (
    *(sys.executable, "-m", "trisk", "run", "williamson5", "--quiet"),
    *("--days", "5", "--dt", "600", "--integrator", "rrk4"),
    *("--snapshot-hours", "0.5", "--diagnostics-hours", "0.25", "--checkpoint-hours", "0.25"),
)
FILES = ("history.nc", "diagnostics.nc")
KILLS_OF_A_RUN = 3
"""A run is killed up to so many times before it may end."""


def command(mesh: Path, directory: Path, *more: str) -> list[str]:
    """The run on `mesh` in `directory`."""
    return [*RUN, "--mesh", str(mesh), "-o", str(directory), *more]


def time_of_run(mesh: Path, directory: Path) -> float:
    """Seconds that the run takes, from when its directory is there, once its kernels are compiled."""
    subprocess.run(command(mesh, directory.with_name("compiled"), "--force"), check=True)
    run = subprocess.Popen(command(mesh, directory))
    _wait_for(directory / "run.json", run, 0)
    begin = time.monotonic()
    assert run.wait() == 0
    return time.monotonic() - begin


def kill_and_resume(mesh: Path, whole: Path, directory: Path, seconds: float, choice: random.Random) -> list[str]:
    """Kill a run at random moments within `seconds`, go on with it to its end; tell what each kill left.

    Raises `AssertionError` where the files are not those of the run in `whole`.
    """
    told = []
    for _ in range(choice.randint(1, KILLS_OF_A_RUN)):
        record = directory / "run.json"
        written = record.stat().st_mtime_ns if record.exists() else 0
        run = subprocess.Popen(command(mesh, directory, "--resume"))
        _wait_for(record, run, written)
        moment = choice.uniform(0.0, seconds)
        try:
            assert run.wait(timeout=moment) == 0
            break
        except subprocess.TimeoutExpired:
            run.kill()
            run.wait()
        checkpoints = sorted(path.name for path in directory.glob("checkpoint.*.npz"))
        halves = ", ".join(path.name.split(".")[1] for path in directory.glob(".*.part")) or "nothing"
        told.append(
            f"after {moment:.2f} s, {checkpoints[-1] if checkpoints else 'no checkpoint'}, {halves} half written"
        )
    subprocess.run(command(mesh, directory, "--resume"), check=True)
    for name in FILES:
        assert (directory / name).read_bytes() == (whole / name).read_bytes(), f"{directory / name} differs"
    assert not list(directory.glob(".*.part"))
    return told


def _wait_for(path: Path, run: subprocess.Popen, before: int) -> None:
    """Wait until the run writes to `path`, last written to at `before` nanoseconds, if at all."""
    while not (path.exists() and path.stat().st_mtime_ns > before):
        assert run.poll() is None, f"the run ended with {run.returncode} before {path} was there"
        time.sleep(0.002)


def main(kills: int, seed: int) -> None:
    """Kill so many times, and tell of it."""
    choice = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        mesh = folder / "mesh.nc"
        subprocess.run([sys.executable, "-m", "trisk", "mesh", "--cells", "2562", "-o", str(mesh), "-q"], check=True)
        seconds = time_of_run(mesh, folder / "whole")
        print(f"a run without a stop takes {seconds:.1f} s")
        done = runs = 0
        while done < kills:
            told = kill_and_resume(mesh, folder / "whole", folder / f"run{runs}", seconds, choice)
            for line in told:
                done += 1
                print(f"kill {done} (run {runs}): {line}; equal in the end", flush=True)
            runs += 1
    print(f"{done} kills of {runs} runs: all files equal, byte for byte")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
