"""Parameters of a case: their units and meaning, and how they are set from text or from the record of a run."""

import ast
import math
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any, get_type_hints

from cases.base import Case
from cases.case_file import line_in, named
from swe.errors import InputError

Value = float | bool | str
"""Of a parameter: a number or a truth value, or the text of one."""

LONGEST_SHOWN = 80
"""Number of characters of a wrong value that an error message quotes."""

KINDS = {float: "a number", int: "a whole number", bool: "true or false"}

ARITHMETIC: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def split_settings(settings: Iterable[str]) -> dict[str, str]:
    """Names and values, as text, of settings NAME=VALUE; the last setting of a name counts."""
    pairs = {}
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not equals:
            raise InputError(f"'{setting}' sets nothing; write NAME=VALUE, as in angle=0.05")
        pairs[name.strip()] = text.strip()
    return pairs


def with_parameters(case: Case, parameters: Mapping[str, Value]) -> Case:
    """`case` with some parameters changed; raises `InputError` for unknown parameters and invalid values."""
    present = case.parameters()
    # The record of a run has lists where a case has tuples.
    parameters = {
        name: tuple(value) if isinstance(value, list) and isinstance(present.get(name), tuple) else value
        for name, value in parameters.items()
    }
    for name in parameters:
        if name not in present:
            raise InputError(f"{case.name} has no parameter '{name}'; choose among {', '.join(present)}")
    try:
        kinds = get_type_hints(type(case))
    except Exception as error:
        raise InputError(f"the types of the parameters of {case.name} cannot be told: {error!r}") from error
    changed: dict[str, Any] = {
        name: _converted(case, name, value, kinds.get(name))
        for name, value in parameters.items()
        if value != present[name]
    }
    if not changed:
        return case
    if not is_dataclass(case):
        raise InputError(f"{case.name} is not a dataclass, so its parameters cannot be changed; change its file")
    try:
        return named(replace(case, **changed), case.name)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        settings = ", ".join(f"{name} = {value!r}" for name, value in changed.items())
        file = case.name.rpartition(":")[0]  # for the name of a case of a user is FILE.py:CLASS
        raise InputError(f"{case.name} cannot be made with {settings}{line_in(file, error)}: {error!r}") from error


def _converted(case: Case, name: str, value: Value, kind: object) -> Value:
    """`value` converted to the annotated type of the parameter; unchanged if there is no annotation."""
    if kind is None:
        return value
    if kind not in KINDS:
        raise InputError(f"{name} of {case.name} is neither a number nor true or false; change it in its file")
    try:
        if kind is bool:
            return _truth(value)
        number = _number(value) if isinstance(value, str) else value
        if isinstance(number, bool) or (kind is int and number != int(number)):
            raise ValueError
        return int(number) if kind is int else float(number)
    except (ValueError, TypeError, OverflowError, ZeroDivisionError, SyntaxError, RecursionError, MemoryError):
        hint = ", such as 0.05 or pi/2-0.05" if kind is float else ""
        shown = value[:LONGEST_SHOWN] if isinstance(value, str) else value
        raise InputError(f"{name} is {shown!r}; it must be {KINDS[kind]}{hint}") from None


def _truth(value: Value) -> bool:
    text = str(value).lower()
    if text not in ("true", "false"):
        raise ValueError
    return text == "true"


def _number(text: str) -> float:
    """A number, or an expression in numbers and pi with + - * /."""
    try:
        return float(text)
    except ValueError:
        return _arithmetic(ast.parse(text, mode="eval").body)


def _arithmetic(node: ast.expr) -> float:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        return float(node.value)
    if isinstance(node, ast.Name) and node.id == "pi":
        return math.pi
    if isinstance(node, ast.BinOp) and type(node.op) in ARITHMETIC:
        return ARITHMETIC[type(node.op)](_arithmetic(node.left), _arithmetic(node.right))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -_arithmetic(node.operand)
    raise ValueError


def units_and_meanings(case: Case) -> dict[str, tuple[str, str]]:
    """Units and meaning of each parameter, as `cases.base.parameter` declares them; empty where nothing does."""
    described: dict[str, Mapping[str, Any]] = {}
    if is_dataclass(case):
        described = {each.name: each.metadata for each in fields(case)}
    metadata = {name: described.get(name, {}) for name in case.parameters()}
    return {name: (str(each.get("units", "")), str(each.get("meaning", ""))) for name, each in metadata.items()}
