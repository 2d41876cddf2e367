"""Which tests reach which lines: a pytest plugin, `pytest -p reach` with REACH=FILE.json in the environment.

Fixtures that several tests share count for all of them. Compiled functions are not traced; a test reaches all lines
of those that it calls, and of those that these call in turn.
"""

import json
import os
from collections.abc import Generator
from pathlib import Path
from typing import Any

import coverage
import numba
import pytest
from numba.core.dispatcher import Dispatcher
from numba.core.registry import CPUDispatcher

ROOT = Path.cwd()
PACKAGES = ("mesh", "swe", "cases", "postprocess", "trisk")


class Reach:
    """Records lines by test or shared fixture, and how long tests take."""

    def __init__(self, output: Path) -> None:
        self._output = output
        self._coverage = coverage.Coverage(
            data_file=None, source=[str(ROOT / name) for name in PACKAGES], config_file=False
        )
        self._contexts: list[str] = []
        self._compiled: dict[str, set[Any]] = {}
        self._fixtures_of: dict[str, list[str]] = {}
        self._seconds: dict[str, float] = {}
        self._coverage.start()
        self._watch_compiled_calls()

    def _watch_compiled_calls(self) -> None:
        original, compiled, contexts = Dispatcher.__call__, self._compiled, self._contexts

        def call(dispatcher: Any, *arguments: Any, **options: Any) -> Any:
            compiled.setdefault(contexts[-1] if contexts else "", set()).add(dispatcher)
            return original(dispatcher, *arguments, **options)

        CPUDispatcher.__call__ = call

    def _enter(self, context: str) -> None:
        self._contexts.append(context)
        self._coverage.switch_context(context)

    def _leave(self) -> None:
        self._contexts.pop()
        self._coverage.switch_context(self._contexts[-1] if self._contexts else "")

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any, request: Any) -> Generator[None]:
        shared = fixturedef.scope != "function"
        if shared:
            self._enter(f"fixture {fixturedef.argname}")
        yield
        if shared:
            self._leave()

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None]:
        self._enter(item.nodeid)
        self._fixtures_of[item.nodeid] = list(getattr(item, "fixturenames", ()))
        yield
        self._leave()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._seconds[report.nodeid] = self._seconds.get(report.nodeid, 0.0) + report.duration

    def pytest_sessionfinish(self) -> None:
        self._coverage.stop()
        lines: dict[str, dict[str, set[int]]] = {}
        data = self._coverage.get_data()
        for path in data.measured_files():
            name = Path(path).resolve().relative_to(ROOT).as_posix()
            for line, contexts in data.contexts_by_lineno(path).items():
                for context in contexts:
                    lines.setdefault(context, {}).setdefault(name, set()).add(line)
        for context, functions in self._compiled.items():
            for function in _with_callees(functions):
                code = function.py_func.__code__
                name = os.path.relpath(code.co_filename, ROOT)
                last = max(line for _, _, line in code.co_lines() if line is not None)
                lines.setdefault(context, {}).setdefault(name, set()).update(range(code.co_firstlineno, last + 1))
        record = {
            "fixtures": self._fixtures_of,
            "seconds": self._seconds,
            "lines": {c: {f: sorted(numbers) for f, numbers in files.items()} for c, files in lines.items()},
        }
        self._output.write_text(json.dumps(record))


def _with_callees(functions: set[Any]) -> set[Any]:
    """Compiled functions with all that they call, directly or not."""
    found, waiting = set(functions), list(functions)
    while waiting:
        code, known = waiting[-1].py_func.__code__, waiting.pop().py_func.__globals__
        for name in code.co_names:
            if isinstance(known.get(name), numba.core.dispatcher.Dispatcher) and known[name] not in found:
                found.add(known[name])
                waiting.append(known[name])
    return found


def pytest_configure(config: pytest.Config) -> None:
    if "REACH" in os.environ:
        config.pluginmanager.register(Reach(Path(os.environ["REACH"])))
