"""The mutants of benchmarks/mutation.py: small faults planted in the syntax tree of one module, and how they get into a
running process.

A mutant is (file, number): the number-th place of the file, in the order in which the tree is walked. Left out are
annotations, docstrings, texts that only people read, imports, and functions under `njit` (and whole modules of them,
SKIPPED): they run from a cache that a fault in the tree does not reach.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.machinery import SourceFileLoader
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
AREAS = {
    "solver/results": ["solver/results"], "solver/frequency_domain": ["solver/frequency_domain"], "store": ["store"],
    "api": ["api"],
}  # fmt: skip
SKIPPED = (
    "solver/frequency_domain/coefficients.py", "solver/frequency_domain/transfer.py", "store/migrations/",
)  # fmt: skip
VARIABLE = "SLOWDRIFT_MUTANT"

COMPARED = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
OPERATED = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult, ast.BitOr: ast.BitAnd, ast.BitAnd: ast.BitOr, ast.MatMult: ast.Mult,
}  # fmt: skip
RENAMED = {
    "max": "min", "min": "max", "maximum": "minimum", "minimum": "maximum", "argmax": "argmin", "argmin": "argmax",
    "sum": "mean", "mean": "sum", "any": "all", "all": "any", "sin": "cos", "cos": "sin", "real": "imag", "imag": "real",
    "first": "second", "second": "first", "asc": "desc", "desc": "asc", "sorted": "list", "std": "var",
}  # fmt: skip
TEXTS = {"print", "warning", "info", "debug", "exception", "NotConverged", "ValueError", "append", "describe"}


@dataclass(frozen=True)
class Mutant:
    """One place: the line, what is done there, and the change of the tree."""

    file: str
    number: int
    line: int
    what: str
    scope: str  # the function it is in; empty at the level of the module or a class
    body: tuple[int, int] = (0, 0)  # first and last line of that function


class _Places(ast.NodeVisitor):
    """Walks a tree and collects (line, what, scope, change)."""

    def __init__(self) -> None:
        self.found: list[tuple[int, str, str, Callable[[], None], tuple[int, int]]] = []
        self.scope: list[str] = []
        self.bodies: list[tuple[int, int]] = [(0, 0)]

    def add(self, node: ast.AST, what: str, change: Callable[[], None]) -> None:
        self.found.append((getattr(node, "lineno", 0), what, ".".join(self.scope), change, self.bodies[-1]))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        if any("njit" in ast.unparse(one) or "overload" in ast.unparse(one) for one in node.decorator_list):
            return
        self.scope.append(node.name)
        self.bodies.append((node.lineno, node.end_lineno or node.lineno))
        for default in [*node.args.defaults, *[one for one in node.args.kw_defaults if one is not None]]:
            self.visit(default)
        for statement in node.body:
            self.visit(statement)
        self.scope.pop()
        self.bodies.pop()

    visit_AsyncFunctionDef = visit_FunctionDef  # type: ignore[assignment]  # noqa: N815

    def visit_Import(self, node: ast.Import) -> None:
        return

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        return

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_Raise(self, node: ast.Raise) -> None:
        return  # that a refusal is not made is the mutant of its condition; its text is for people

    def visit_Assert(self, node: ast.Assert) -> None:
        return

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        return

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Constant):
            return
        if isinstance(node.value, ast.Call | ast.Await) and self.scope:
            self.add(node, f"drop `{_short(node)}`", lambda: _become(node, ast.Pass()))
        self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        if "TYPE_CHECKING" in ast.unparse(node.test):
            return
        self.add(node, f"if not ({_short(node.test)})", lambda: setattr(node, "test", _negated(node.test)))
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        def swap() -> None:
            node.body, node.orelse = node.orelse, node.body

        self.add(node, f"swapped branches of `{_short(node)}`", swap)
        self.generic_visit(node)

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is not None and not (isinstance(node.value, ast.Constant) and node.value.value is None):
            self.add(
                node, f"return None for `{_short(node.value)}`", lambda: setattr(node, "value", ast.Constant(None))
            )
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        for k, operator in enumerate(node.ops):
            other = COMPARED[type(operator)]
            self.add(
                node, f"{type(operator).__name__} -> {other.__name__} in `{_short(node)}`", _put(node.ops, k, other())
            )
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        other = OPERATED.get(type(node.op))
        texts = any(isinstance(side, ast.Constant) and isinstance(side.value, str) for side in (node.left, node.right))
        if other is not None and not texts:
            what = f"{type(node.op).__name__} -> {other.__name__} in `{_short(node)}`"
            self.add(node, what, lambda: setattr(node, "op", other()))
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        other = OPERATED.get(type(node.op))
        if other is not None:
            self.add(node, f"{type(node.op).__name__} -> {other.__name__} in `{_short(node)}`",
                     lambda: setattr(node, "op", other()))  # fmt: skip
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        other = ast.Or if isinstance(node.op, ast.And) else ast.And
        self.add(node, f"-> {other.__name__} in `{_short(node)}`", lambda: setattr(node, "op", other()))
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not | ast.USub | ast.Invert):
            what = f"drop {type(node.op).__name__} in `{_short(node)}`"
            self.add(node, what, lambda: setattr(node, "op", ast.UAdd()) if not isinstance(node.op, ast.Not)
                     else _become(node, _call("bool", node.operand)))  # fmt: skip
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if isinstance(value, bool):
            self.add(node, f"{value} -> {not value}", lambda: setattr(node, "value", not value))
        elif isinstance(value, int):
            self.add(node, f"{value} -> {value + 1}", lambda: setattr(node, "value", value + 1))
        elif isinstance(value, float):
            new = 2.0 * value if value else 1.0
            self.add(node, f"{value} -> {new}", lambda: setattr(node, "value", new))

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, str):
            key = node.slice
            self.add(node, f"key {key.value!r} renamed", lambda: setattr(key, "value", f"{key.value}_x"))
        self.generic_visit(node)

    def visit_Dict(self, node: ast.Dict) -> None:
        for key in node.keys:
            if isinstance(key, ast.Constant) and isinstance(key.value, str):
                text = key
                self.add(key, f"key {key.value!r} renamed", _rename(text))
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in RENAMED and isinstance(node.func, ast.Attribute):
            self.add(
                node,
                f"{name} -> {RENAMED[name]} in `{_short(node)}`",
                lambda: setattr(node.func, "attr", RENAMED[name]),
            )
        elif name in RENAMED and name not in ("first", "second", "std", "mean"):
            self.add(
                node, f"{name} -> {RENAMED[name]} in `{_short(node)}`", lambda: setattr(node.func, "id", RENAMED[name])
            )
        elif name in ("sqrt", "abs", "conj", "unique") and node.args:
            self.add(node, f"drop {name} in `{_short(node)}`", lambda: _become(node, node.args[0]))
        self.generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if node.attr in ("real", "imag", "first", "second") and isinstance(node.ctx, ast.Load):
            self.add(node, f"{node.attr} -> {RENAMED[node.attr]}", lambda: setattr(node, "attr", RENAMED[node.attr]))
        self.generic_visit(node)


def _rename(node: ast.Constant) -> Callable[[], None]:
    return lambda: setattr(node, "value", f"{node.value}_x")


def _short(node: ast.AST) -> str:
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= 70 else text[:67] + "..."


def _call(name: str, argument: ast.expr) -> ast.Call:
    return ast.Call(ast.Name(name, ast.Load()), [argument], [])


def _negated(test: ast.expr) -> ast.expr:
    return ast.UnaryOp(ast.Not(), test)


def _put(items: list[Any], index: int, new: Any) -> Callable[[], None]:
    return lambda: items.__setitem__(index, new)


def _become(node: ast.AST, other: ast.AST) -> None:
    """Turn a node into another in place."""
    place = {key: getattr(node, key) for key in ("lineno", "col_offset", "end_lineno", "end_col_offset")}
    fields = dict(ast.iter_fields(other))
    node.__class__ = other.__class__  # type: ignore[assignment]
    node.__dict__.clear()
    node.__dict__.update(fields, **place)


def _tree(file: str) -> tuple[ast.Module, _Places]:
    tree = ast.parse((ROOT / file).read_text())
    places = _Places()
    places.visit(tree)
    return tree, places


def mutants(area: str) -> Iterator[Mutant]:
    """Every mutant of an area, in the order of its files."""
    for folder in AREAS[area]:
        for path in sorted((ROOT / folder).rglob("*.py")):
            file = str(path.relative_to(ROOT))
            if not file.startswith(SKIPPED):
                for number, (line, what, scope, _, body) in enumerate(_tree(file)[1].found):
                    yield Mutant(file, number, line, what, scope, body)


def mutated(file: str, number: int) -> Any:
    """The code object of a module with one mutant in it."""
    tree, places = _tree(file)
    places.found[number][3]()
    return compile(ast.fix_missing_locations(tree), str(ROOT / file), "exec", dont_inherit=True)


def plant(file: str, number: int) -> None:
    """From now on this process, and those that it starts with `site_folder` on their path, import the mutant."""
    os.environ[VARIABLE] = f"{file}:{number}"
    code, target = mutated(file, number), str(ROOT / file)
    plain = SourceFileLoader.get_code

    def get_code(self: SourceFileLoader, fullname: str) -> Any:
        return code if self.path == target else plain(self, fullname)

    SourceFileLoader.get_code = get_code  # type: ignore[method-assign]


SITE = """import os, sys
if "SLOWDRIFT_MUTANT" in os.environ:
    sys.path.append({root!r})
    from benchmarks.mutants import plant
    file, number = os.environ["SLOWDRIFT_MUTANT"].rsplit(":", 1)
    plant(file, int(number))
    sys.path.remove({root!r})
"""


def site_folder(place: Path) -> Path:
    """A folder for PYTHONPATH whose `sitecustomize` plants the mutant in programs that tests start."""
    place.mkdir(parents=True, exist_ok=True)
    (place / "sitecustomize.py").write_text(SITE.format(root=str(ROOT)))
    return place
