"""Small faults that a source file can be given: every place, and what would stand there instead.

Types, decorators, docstrings, and the prose of messages and of help are left alone: no test of a value can see them.
"""

import ast
import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

PACKAGES = ("mesh", "swe", "cases", "postprocess", "trisk")

OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.FloorDiv: "*",
    ast.Mod: "*",
    ast.Pow: "*",
    ast.BitAnd: "|",
    ast.BitOr: "&",
}
COMPARISONS: dict[type[ast.AST], tuple[str, ...]] = {
    ast.Lt: ("<=", ">"),
    ast.LtE: ("<", ">"),
    ast.Gt: (">=", "<"),
    ast.GtE: (">", "<"),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
}
PROSE_CALLS = ("Option", "Argument", "Typer", "warn", "add_typer", "TypeVar")
"""Calls whose strings are prose for people."""


@dataclass(frozen=True)
class Mutation:
    """Bytes [start, stop) of `path` become `new`.

    They stand in `line`, in the statement that begins in line `statement`, in `function`, which is empty where they are
    evaluated when the module is imported.
    """

    path: str
    line: int
    statement: int
    start: int
    stop: int
    new: str
    kind: str
    function: str

    @property
    def name(self) -> str:
        """What tells it from all others."""
        return f"{self.path}:{self.line}:{self.start}-{self.stop}:{self.new}"

    def mutant(self, root: Path) -> bytes:
        """The source with the fault."""
        source = (root / self.path).read_bytes()
        return source[: self.start] + self.new.encode() + source[self.stop :]

    def apply(self, root: Path) -> None:
        """Write the fault into the file below `root`."""
        (root / self.path).write_bytes(self.mutant(root))

    def is_python(self, root: Path) -> bool:
        """Whether the source with the fault can be compiled."""
        try:
            compile(self.mutant(root), self.path, "exec")
        except (SyntaxError, ValueError):
            return False
        return True

    def shown(self, root: Path) -> str:
        """The line before and after, as one line of text."""
        source = (root / self.path).read_bytes()
        first, last = source.rfind(b"\n", 0, self.start) + 1, source.find(b"\n", self.stop)
        after = source[first : self.start] + self.new.encode() + source[self.stop : last]
        return f"{source[first:last].decode().strip()}  ->  {after.decode().strip()}"


def draw(root: Path, count: int, seed: int) -> list[Mutation]:
    """So many different mutations of all packages: the kind is drawn first, then one of that kind."""
    by_kind: dict[str, list[Mutation]] = {}
    for path in sorted(path for package in PACKAGES for path in (root / package).rglob("*.py")):
        for mutation in mutations(path.relative_to(root).as_posix(), path.read_bytes()):
            by_kind.setdefault(mutation.kind, []).append(mutation)
    generator, chosen = random.Random(seed), []
    while len(chosen) < count:
        of_kind = by_kind[generator.choice(sorted(by_kind))]
        mutation = of_kind.pop(generator.randrange(len(of_kind)))
        if mutation.is_python(root):
            chosen.append(mutation)
    return chosen


def mutations(path: str, source: bytes) -> list[Mutation]:
    """All mutations of one file."""
    finder = _Finder(path, source)
    finder.visit(ast.parse(source))
    return finder.found


class _Finder(ast.NodeVisitor):
    def __init__(self, path: str, source: bytes) -> None:
        self.found: list[Mutation] = []
        self._path, self._source = path, source
        self._starts = [0]
        for line in source.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))
        self._function = ""
        self._statement = 1
        self._prose = 0

    def visit(self, node: ast.AST) -> None:
        """Visit a node, and remember the statement that it belongs to."""
        if isinstance(node, ast.stmt):
            self._statement = node.lineno
        super().visit(node)

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self._starts[node.lineno - 1] + node.col_offset, self._starts[node.end_lineno - 1] + node.end_col_offset

    def _add(self, node: ast.expr | ast.stmt, span: tuple[int, int], new: str, kind: str) -> None:
        line = self._source.count(b"\n", 0, span[0]) + 1
        self.found.append(Mutation(self._path, line, self._statement, *span, new, kind, self._function))

    def _text(self, node: ast.expr) -> str:
        start, stop = self._span(node)
        return self._source[start:stop].decode()

    def _between(self, left: ast.expr, right: ast.expr, old: str) -> tuple[int, int] | None:
        """Where an operator stands between two operands."""
        start, stop = self._span(left)[1], self._span(right)[0]
        at = self._source.find(old.encode(), start, stop)
        return None if at < 0 else (at, at + len(old))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for default in (*node.args.defaults, *(value for value in node.args.kw_defaults if value is not None)):
            self.visit(default)
        outside, self._function = self._function, node.name
        for statement in node.body:
            self.visit(statement)
        self._function = outside

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        for statement in node.body:
            self.visit(statement)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        names = {target.id for target in node.targets if isinstance(target, ast.Name)}
        if "__all__" not in names:
            self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Constant):
            return
        if isinstance(node.value, ast.Call) and not self._prose:
            self._add(node, self._span(node), "pass", "statement")
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        old = {ast.Add: "+=", ast.Sub: "-=", ast.Mult: "*=", ast.Div: "/="}.get(type(node.op))
        span = self._between(node.target, node.value, old) if old else None
        if span is not None:
            self._add(node, span, OPERATORS[type(node.op)] + "=", "operator")
        self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        if not (isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"):
            self.generic_visit(node)

    def visit_Import(self, node: ast.Import) -> None:
        return

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        return

    def visit_Raise(self, node: ast.Raise) -> None:
        self._in_prose(node)

    def _in_prose(self, node: ast.AST) -> None:
        self._prose += 1
        self.generic_visit(node)
        self._prose -= 1

    def visit_BinOp(self, node: ast.BinOp) -> None:
        symbols = {
            **{ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%"},
            **{ast.Pow: "**", ast.BitAnd: "&", ast.BitOr: "|"},
        }
        old = symbols.get(type(node.op))
        span = self._between(node.left, node.right, old) if old else None
        if span is not None and not isinstance(node.left, ast.Constant | ast.JoinedStr):
            self._add(node, span, OPERATORS[type(node.op)], "operator")
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.USub | ast.Not | ast.Invert):
            self._add(node, self._span(node), self._text(node.operand), "sign")
        if not (isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant)):
            self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        symbols = {
            **{ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="},
            **{ast.Is: "is", ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in"},
        }
        left = node.left
        for operator, right in zip(node.ops, node.comparators, strict=True):
            span = self._between(left, right, symbols[type(operator)])
            for new in COMPARISONS[type(operator)] if span is not None else ():
                assert span is not None
                self._add(node, span, new, "comparison")
            left = right
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        span = self._between(node.values[0], node.values[1], old)
        if span is not None:
            self._add(node, span, new, "comparison")
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        for first, second in zip(node.args, node.args[1:], strict=False):
            if all(isinstance(argument, ast.Name | ast.Attribute | ast.Subscript) for argument in (first, second)):
                span = (self._span(first)[0], self._span(second)[1])
                self._add(node, span, f"{self._text(second)}, {self._text(first)}", "arguments")
        if called in PROSE_CALLS:
            self._in_prose(node)
        else:
            self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        for new, kind in _other_values(node.value, self._prose > 0):
            self._add(node, self._span(node), new, kind)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Of a formatted string the values are mutated, not the words between them.

        Before Python 3.12 the places of some of them are wrong; these are left out.
        """
        for part in node.values:
            if isinstance(part, ast.FormattedValue) and self._is_where_it_says(part.value):
                self.visit(part.value)

    def _is_where_it_says(self, node: ast.expr) -> bool:
        try:
            return ast.dump(ast.parse(self._text(node), mode="eval").body) == ast.dump(node)
        except (SyntaxError, ValueError):
            return False


def _other_values(value: object, prose: bool) -> Iterator[tuple[str, str]]:
    """What else a constant might be."""
    if isinstance(value, bool):
        yield str(not value), "constant"
    elif isinstance(value, int):
        yield str(value + 1), "constant"
    elif isinstance(value, float):
        yield repr(2.0 * value if value else 1.0), "constant"
    elif isinstance(value, str) and value.strip() and not prose:
        yield repr(value + "x" if " " not in value else value[: value.rfind(" ")]), "text"
