"""A look at the text of functions of users before numba compiles them: fields that there are, changes that stay."""

from __future__ import annotations

import ast
from collections.abc import Callable
from difflib import get_close_matches
from functools import cache
from inspect import getsource
from pathlib import Path
from textwrap import dedent
from typing import Any, get_type_hints

from dincl.errors import InvalidProblem
from tissue.state.cells import Forces
from tissue.state.numbers import Numbers
from tissue.state.running import StateArrays

PAGE = "docs/extend/cell.md"
# What the arguments of each function are, by position; None: a number.
ARGUMENTS: dict[str, tuple[type | None, ...]] = {
    "begin": (StateArrays, None, None, Numbers),
    "last": (StateArrays, None, None, None, Numbers),
    "splits": (StateArrays, None, None, Numbers),
    "place": (StateArrays, None, Numbers),
    "push": (StateArrays, Forces, None, Numbers),
    "energy": (StateArrays, None, Numbers),
}
# Set anew in each dt behind divisions and the begin of events, by ``tissue.model.cycle.set_phases``.
OVERWRITTEN = frozenset({"state.cells.radius", "state.cells.stiff_aa"})
ROOTS = {StateArrays: "state", Forces: "on", Numbers: "numbers"}
# A part of an argument: its type and its name, such as "state.cells".
Value = tuple[Any, str]


def check_code(thing: Any) -> None:
    """Check the functions of what a user registers.

    Raises
    ------
    InvalidProblem
        If one names a field that there is not, or changes what is set anew before it is used.
    """
    for part, kinds in ARGUMENTS.items():
        function = getattr(thing, part, None)
        if function is None:
            continue
        try:
            tree = ast.parse(dedent(getsource(function)))
        except (OSError, SyntaxError):  # the text is not there, or is a part of a line
            continue
        code = function.__code__
        ast.increment_lineno(tree, code.co_firstlineno - 1)
        name = f"{type(thing).__name__} {thing.name}: {part} in {Path(code.co_filename).name}"
        _Reader(name, part, kinds).visit(tree)


class _Reader(ast.NodeVisitor):
    """Follows the arguments of one function through its text."""

    def __init__(self, name: str, part: str, kinds: tuple[type | None, ...]) -> None:
        self._name, self._part, self._kinds = name, part, kinds
        self._values: dict[str, Value | None] = {}

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        names = (argument.arg for argument in (*node.args.posonlyargs, *node.args.args))
        self._values = {name: (kind, ROOTS[kind]) for name, kind in zip(names, self._kinds, strict=False) if kind}
        for line in node.body:
            self.visit(line)

    def visit_Assign(self, node: ast.Assign) -> None:
        self.visit(node.value)
        for target in node.targets:
            self._assign(target, node.value)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self.visit(node.value)
        self._assign(node.target, None)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if self._value(node) is None:
            self.generic_visit(node)

    def _assign(self, target: ast.expr, value: ast.expr | None) -> None:
        """Note what a name stands for from here on, and refuse a change that is lost."""
        if isinstance(target, ast.Tuple):
            several = value.elts if isinstance(value, ast.Tuple) and len(value.elts) == len(target.elts) else None
            for k, one in enumerate(target.elts):
                self._assign(one, several[k] if several else None)
        elif isinstance(target, ast.Name):
            found = self._value(value) if value is not None else None
            if found != self._values.setdefault(target.id, found):
                self._values[target.id] = None  # by now one of two
        elif isinstance(target, ast.Subscript):
            self.visit(target)
            self._refuse_lost(target, self._value(target.value))

    def _refuse_lost(self, node: ast.expr, written: Value | None) -> None:
        place = written[1] if written else ""
        what = f"{self._name}, line {node.lineno}, changes {place}"
        if place in OVERWRITTEN and self._part in ("begin", "splits", "place"):
            raise InvalidProblem(f"{what}: must be in last, as the phase of the cell sets it in each dt; see {PAGE}")
        if self._part in ("push", "energy") and place.startswith("state.") and not place.startswith("state.on"):
            raise InvalidProblem(f"{what}: must change nothing of the state, which the rules set; see {PAGE}")

    def _value(self, node: ast.expr) -> Value | None:
        """Find what an expression is, if it is a part of an argument."""
        if isinstance(node, ast.Name):
            return self._values.get(node.id)
        found = self._value(node.value) if isinstance(node, ast.Attribute) else None
        if found is None or not isinstance(node, ast.Attribute) or not hasattr(found[0], "_fields"):
            return None
        kind, place = found
        if node.attr not in kind._fields:
            near = get_close_matches(node.attr, kind._fields, 1, 0.0)
            raise InvalidProblem(
                f"{self._name}, line {node.lineno}: {ast.unparse(node)} is unknown; the nearest is {near[0]} of "
                f"{', '.join(kind._fields)}; see {PAGE}"
            )
        return _hints(kind)[node.attr], f"{place}.{node.attr}"


@cache
def _hints(kind: Callable[..., Any]) -> dict[str, Any]:
    return get_type_hints(kind)
