"""How many small faults the tests notice: python tests/mutation/mutants.py FOLDER [--count N] [--seed S].

Draws mutations over all packages, and for each runs, in a copy of the project, the quick tests that reach its lines,
until one fails. What has been found is kept in FOLDER, from which an interrupted call goes on.
"""

import argparse
import ast
import concurrent.futures
import json
import math
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

from mutations import PACKAGES, Mutation, draw

ROOT = Path(__file__).resolve().parents[2]
COPIED = (*PACKAGES, "tests", "docs", "pyproject.toml", "README.md", "CITATION.cff", "CHANGELOG.md", "Makefile")
LEAST_SECONDS = 120.0
"""Time allowed to the tests of a mutant, beyond `PATIENCE` times what they took without it."""

PATIENCE = 5.0
QUICK = ["-m", "not slow", "-q", "-p", "no:cacheprovider"]


class Copy:
    """A copy of the project in which files are broken, with its own compiled functions, and what pytest said last."""

    def __init__(self, folder: Path, original: Path = ROOT) -> None:
        self.folder, self.cache, self.reach = folder / "project", folder / "compiled", folder / "reach.json"
        self.log = folder / "pytest.log"
        if not self.folder.exists():
            for name in COPIED:
                source, target = original / name, self.folder / name
                if source.is_dir():
                    shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__", ".hypothesis"))
                elif source.exists():
                    target.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(source, target)

    def survey_reach(self) -> int | None:
        """Run all quick tests, note what they reach, and keep the compiled functions; gives pytest's exit code."""
        return self.run(["-p", "reach"], self.cache, None, REACH=str(self.reach))

    def run(self, arguments: list[str], cache: Path, seconds: float | None, **environment: str) -> int | None:
        """Exit code of pytest, None where the time is over."""
        variables = {
            **{**os.environ, "PYTHONPATH": f"{self.folder}{os.pathsep}{Path(__file__).parent}"},
            **{"NUMBA_CACHE_DIR": str(cache), "PYTHONDONTWRITEBYTECODE": "1", **environment},
        }
        with self.log.open("w") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "pytest", *QUICK, *arguments],
                cwd=self.folder,
                env=variables,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
            try:
                return process.wait(seconds)
            except subprocess.TimeoutExpired:
                return None
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()

    def verdict(self, mutation: Mutation, tests: list[str], seconds: float) -> str:
        """What the tests say of a mutation: `killed`, `killed by time` or `survived`."""
        if not tests:
            return "survived: no test reaches it"
        original = (self.folder / mutation.path).read_bytes()
        with tempfile.TemporaryDirectory(dir=self.folder.parent) as scratch:
            cache, names = Path(scratch) / "compiled", Path(scratch) / "tests"
            shutil.copytree(self.cache, cache, copy_function=os.link)
            names.write_text("\n".join(tests))
            try:
                mutation.apply(self.folder)
                code = self.run(["-x", f"@{names}"], cache, seconds)
                if "ERROR: not found" in self.log.read_text(errors="replace"):
                    # A mutant may change the names of tests that are made from what it breaks.
                    code = self.run(["-x", *dict.fromkeys(file_of(test) for test in tests)], cache, seconds)
            finally:
                (self.folder / mutation.path).write_bytes(original)
        if code is None:
            return "killed by time"
        return "survived" if code == 0 else "killed"


def reach(folder: Path, copies: list[Copy]) -> dict[str, Any]:
    """What tests reach which lines; makes every copy compile what the tests call."""
    record = folder / "reach.json"
    if not record.exists():
        print("running the tests without a fault", flush=True)
        with concurrent.futures.ThreadPoolExecutor(len(copies)) as pool:
            codes = list(pool.map(Copy.survey_reach, copies))
        if any(codes):
            raise SystemExit(f"the tests fail without a fault (exit codes {codes}); see {folder}/*/pytest.log")
        shutil.copy(copies[0].reach, record)
    return dict(json.loads(record.read_text()))


def importers(root: Path, module: str) -> set[str]:
    """Paths of the modules below `root` that import from `module`, and its own."""
    dotted = module.removesuffix(".py").replace("/", ".").removesuffix(".__init__")
    found = {module}
    for package in PACKAGES:
        for path in (root / package).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_bytes())):
                names = [node.module] if isinstance(node, ast.ImportFrom) else []
                names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                if isinstance(node, ast.ImportFrom):
                    names += [f"{node.module}.{alias.name}" for alias in node.names]
                if dotted in names:
                    found.add(path.relative_to(root).as_posix())
    return found


def reaching_tests(root: Path, mutation: Mutation, known: dict[str, Any]) -> list[str]:
    """Tests that reach a mutation, those of its own module and package first, then quick files."""
    everywhere = importers(root, mutation.path) if not mutation.function else set()
    numbers = {mutation.line, mutation.statement}

    def reaches(context: str) -> bool:
        files = known["lines"].get(context, {})
        return bool(everywhere & set(files)) or bool(numbers & set(files.get(mutation.path, ())))

    reached = {context for context in known["lines"] if context and reaches(context)}
    tests = [
        test
        for test, fixtures in known["fixtures"].items()
        if test in reached or any(f"fixture {fixture}" in reached for fixture in fixtures)
    ]
    module = f"test_{Path(mutation.path).stem}.py"
    # What only other processes do is not traced; then the tests that are named after the module are asked.
    tests = tests or [test for test in known["fixtures"] if module in test]
    # Tests of one file stay together, as they share what is made for them.
    of_file = Counter[str]()
    for test in tests:
        of_file[file_of(test)] += known["seconds"].get(test, 0.0)
    package = f"tests/{mutation.path.split('/')[0]}/"

    def order(test: str) -> tuple[bool, bool, float, str]:
        return module not in test, not test.startswith(package), of_file[file_of(test)], file_of(test)

    return sorted(tests, key=order)


def file_of(test: str) -> str:
    """The file that a test stands in."""
    return test.split("::")[0]


def within(budget: float, tests: list[str], seconds: dict[str, float]) -> list[str]:
    """The first tests, of which all together take no more than `budget` seconds."""
    total, chosen = 0.0, []
    for test in tests:
        total += seconds.get(test, 0.0)
        if total > budget:
            break
        chosen.append(test)
    return chosen


def report(results: dict[str, dict[str, str]]) -> str:
    """Killed of all by file, and the survivors."""
    drawn, killed = Counter[str](), Counter[str]()
    for result in results.values():
        drawn[result["path"]] += 1
        killed[result["path"]] += result["verdict"].startswith("killed")
    lines = [f"{killed.total()} of {drawn.total()} mutants killed", ""]
    lines += [f"{path}: {killed[path]} of {drawn[path]}" for path in sorted(drawn)]
    lines += ["", "Survivors"]
    for name, result in sorted(results.items()):
        if not result["verdict"].startswith("killed"):
            lines.append(f"{name.split(':')[0]}:{name.split(':')[1]} ({result['verdict']})\n    {result['shown']}")
    return "\n".join(lines)


class Survey:
    """The verdicts of many mutations of the project at `root`, kept in a journal from which a survey goes on."""

    def __init__(self, root: Path, journal: Path, copies: list[Copy], known: dict[str, Any], budget: float) -> None:
        self._root, self._journal, self._known, self._workers = root, journal, known, len(copies)
        self._budget = budget
        self._free: queue.Queue[Copy] = queue.Queue()
        for copy in copies:
            self._free.put(copy)
        lines = journal.read_text().splitlines() if journal.exists() else []
        self.results: dict[str, dict[str, str]] = dict(json.loads(line) for line in lines)

    def judge_all(self, mutations: list[Mutation]) -> None:
        """Find the verdicts that are missing, and tell each."""
        waiting = [mutation for mutation in mutations if mutation.name not in self.results]
        with concurrent.futures.ThreadPoolExecutor(self._workers) as pool:
            for done in concurrent.futures.as_completed([pool.submit(self._judge, mutation) for mutation in waiting]):
                name, result = done.result()
                self.results[name] = result
                with self._journal.open("a") as file:
                    file.write(json.dumps([name, result]) + "\n")
                print(f"{len(self.results)}: {result['verdict']}: {name}: {result['shown']}", flush=True)

    def _judge(self, mutation: Mutation) -> tuple[str, dict[str, str]]:
        tests = within(self._budget, reaching_tests(self._root, mutation, self._known), self._known["seconds"])
        seconds = LEAST_SECONDS + PATIENCE * sum(self._known["seconds"].get(test, 0.0) for test in tests)
        copy = self._free.get()
        try:
            verdict = copy.verdict(mutation, tests, seconds)
        finally:
            self._free.put(copy)
        shown = mutation.shown(self._root)
        return mutation.name, {"path": mutation.path, "kind": mutation.kind, "verdict": verdict, "shown": shown}


def main() -> None:
    """Draw mutants and report which the tests notice."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--budget", type=float, default=math.inf, help="seconds of tests for each, all by default")
    options = parser.parse_args()
    folder = options.folder.resolve()
    drawn_from = Copy(folder / "original").folder  # stays as it is, whatever happens to the project meanwhile
    copies = [Copy(folder / f"copy-{number}", drawn_from) for number in range(options.workers)]
    survey = Survey(drawn_from, folder / f"seed-{options.seed}.jsonl", copies, reach(folder, copies), options.budget)
    survey.judge_all(draw(drawn_from, options.count, options.seed))
    print(report(survey.results))


if __name__ == "__main__":
    main()
