"""Mutants of a source text: one operator, sign, constant, function or statement is replaced."""

import ast
import copy
from collections.abc import Iterator
from typing import NamedTuple

BINARY = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.FloorDiv,
    ast.Pow: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
COMPARISONS = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.GtE),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
}
BOOLEAN = {ast.And: ast.Or, ast.Or: ast.And}
PAIRS = (
    ("min", "max"),
    ("minimum", "maximum"),
    ("argmin", "argmax"),
    ("floor", "ceil"),
    ("sin", "cos"),
    ("any", "all"),
)
NAMES = {old: new for pair in PAIRS for old, new in (pair, pair[::-1])}
# Their constants and operators make no numbers: messages, and what is there for type checkers.
SKIPPED = (ast.Raise, ast.JoinedStr, ast.Import, ast.ImportFrom)


class Mutant(NamedTuple):
    """A text that differs from its original at one place, inside of the function or class ``scope``."""

    scope: str
    line: int
    before: str
    after: str
    text: str


def mutants(text: str) -> Iterator[Mutant]:
    """Yield all mutants of a source text, in the order of their places."""
    lines = text.encode().splitlines(keepends=True)
    starts = [sum(map(len, lines[:k])) for k in range(len(lines))]
    for scope, node in places("", ast.parse(text)):
        first = starts[node.lineno - 1] + node.col_offset
        last = starts[node.end_lineno - 1] + node.end_col_offset
        for after in replacements(node):
            mutated = text.encode()[:first] + after.encode() + text.encode()[last:]
            yield Mutant(scope, node.lineno, ast.unparse(node), after, mutated.decode())


def places(scope: str, node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield the nodes that may be replaced, each with the name of the function or class around it."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, SKIPPED) or is_about_types(node, child):
            continue
        if isinstance(child, ast.expr | ast.stmt):
            yield scope, child
        inner = child.name if isinstance(child, ast.FunctionDef | ast.ClassDef) else scope
        yield from places(inner, child)


def is_about_types(parent: ast.AST, child: ast.AST) -> bool:
    """Tell whether a node is a decorator, an annotation or a block for type checkers."""
    if isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING":
        return True
    named = (getattr(parent, name, None) for name in ("annotation", "returns"))
    return any(child is each for each in named) or child in getattr(parent, "decorator_list", ())


def replacements(node: ast.AST) -> Iterator[str]:
    """Yield what may stand in place of a node."""
    match node:
        case ast.BinOp(op=op) | ast.AugAssign(op=op) if type(op) in BINARY and not is_text(node):
            yield changed(node, op=BINARY[type(op)]())
        case ast.BoolOp(op=op):
            yield changed(node, op=BOOLEAN[type(op)]())
        case ast.Compare(ops=[op]):
            yield from (changed(node, ops=[new()]) for new in COMPARISONS.get(type(op), ()))
        case ast.UnaryOp(op=ast.USub() | ast.Not(), operand=operand):
            yield f"({ast.unparse(operand)})"
        case ast.Constant(value=value) if type(value) in (int, float):
            yield repr(value + 1 if type(value) is int else 2 * value or 1.0)
        case ast.Call(func=ast.Name(id=name)) if name in NAMES:
            yield changed(node, func=ast.Name(NAMES[name]))
        case ast.Call(func=ast.Attribute(attr=name)) if name in NAMES:
            yield changed(node, func=ast.Attribute(node.func.value, NAMES[name]))
        case ast.Attribute(attr="inf"):
            yield f"(-{ast.unparse(node)})"
    match node:
        case ast.Expr(value=ast.Call()) | ast.AugAssign() | ast.Assign(targets=[ast.Subscript() | ast.Attribute()]):
            yield "pass"


def is_text(node: ast.BinOp | ast.AugAssign) -> bool:
    """Tell whether a sum joins texts or lists."""
    literal = ast.JoinedStr | ast.List | ast.Tuple | ast.ListComp
    operands = [node.left, node.right] if isinstance(node, ast.BinOp) else [node.value]
    return any(isinstance(each, literal) or isinstance(getattr(each, "value", None), str) for each in operands)


def changed(node: ast.AST, **fields: object) -> str:
    """Write a node with other fields, an expression in brackets."""
    new = copy.copy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return f"({ast.unparse(new)})" if isinstance(node, ast.expr) else ast.unparse(new)
