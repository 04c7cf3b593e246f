"""The source files of the program: what each says without its prose, and which modules it imports."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.util import decode_source
from pathlib import Path
from typing import NamedTuple

MAKES_NO_NUMBERS = True
# A module that sets this to True at top level draws or talks: no number depends on it, nor on what it imports.
END = "MAKES_NO_NUMBERS"
FINDERS = ("import_module", "__import__")


class Import(NamedTuple):
    """``import module``, if ``name`` is "", or ``from module import name``, with so many dots before the module."""

    level: int
    module: str
    name: str = ""


@dataclass(frozen=True)
class Source:
    """What there is to know of a source file.

    Attributes
    ----------
    digest
        Of its text without docstrings, lines of comment, blank lines and what is there for type checkers alone.
    imports
        At any depth.
    dynamic
        Whether it imports modules by names that are computed.
    binds
        The names given to something at top level.
    makes_numbers
        False if it says ``MAKES_NO_NUMBERS = True``.
    """

    digest: str
    imports: frozenset[Import] = frozenset()
    dynamic: bool = False
    binds: frozenset[str] = frozenset()
    makes_numbers: bool = True


def read_source(path: Path) -> Source:
    """A source file; it is read again only if its time or size has changed. Of a compiled one, the bytes."""
    found = path.stat()
    return _read(path, found.st_mtime_ns, found.st_size)


def digest_of(data: bytes) -> str:
    """A short name for bytes."""
    return sha256(data).hexdigest()[:16]


@cache
def _read(path: Path, _mtime: int, _size: int) -> Source:
    data = path.read_bytes()
    return source(decode_source(data)) if path.suffix == ".py" else Source(digest_of(data))


def source(text: str) -> Source:
    """What there is to know of a source text."""
    tree = ast.parse(text)
    statements = _statements(tree.body)
    imports = {found for statement in statements for found in _imports(statement)}
    found_by_call = {_constant(call) for call in _finding_calls(text, tree)}
    top = [statement for statement in tree.body if not isinstance(statement, ast.Expr)]
    return Source(
        digest=digest_of(code_of(text, tree)),
        imports=frozenset(imports | {found for found in found_by_call if found is not None}),
        dynamic=None in found_by_call,
        binds=frozenset(name for statement in _statements(top) for name in _bound(statement)),
        makes_numbers=not any(_is_end(statement) for statement in top),
    )


def code_of(text: str, tree: ast.Module) -> bytes:
    """The text without docstrings, lines of comment, blank lines and the bodies of ``if TYPE_CHECKING:``."""
    lines = text.encode().split(b"\n")
    cut: set[int] = set()
    for node in _left_out(tree):
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        before, after = lines[first][: node.col_offset], lines[last][node.end_col_offset :]
        lines[first : last + 1] = [before + after, *[b""] * (last - first)]
        cut.update(range(first, last + 1))
    left = b"\n".join(lines)
    kept = _lines_of_strings(tree) - cut if any(mark in left for mark in (b'"""', b"'''", b"\\\n")) else set()
    return b"\n".join(line for number, line in enumerate(lines) if number in kept or not _is_prose(line))


def _is_prose(line: bytes) -> bool:
    return not line.strip() or line.lstrip().startswith(b"#")


def _lines_of_strings(tree: ast.Module) -> set[int]:
    """The lines on which a string of several lines goes on, in which nothing is a comment."""
    return {
        number
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant | ast.JoinedStr) and node.end_lineno
        for number in range(node.lineno, node.end_lineno)
    }


def _left_out(tree: ast.Module) -> list[ast.stmt]:
    """Docstrings, and statements for type checkers; the last first, so that cutting one leaves the others in place."""
    found = [tree.body[0]] if _has_docstring(tree) else []
    for node in _statements(tree.body):
        if isinstance(node, ast.If) and _for_types(node):
            found += node.body
        elif _has_docstring(node):
            found.append(node.body[0])  # type: ignore[attr-defined]
    return sorted(found, key=lambda node: (node.lineno, node.col_offset), reverse=True)


def _has_docstring(node: ast.AST) -> bool:
    match node:
        case ast.Module() | ast.ClassDef() | ast.FunctionDef() | ast.AsyncFunctionDef():
            match node.body:
                case [ast.Expr(value=ast.Constant(value=str())), *_]:
                    return True
    return False


def _statements(body: list[ast.stmt]) -> list[ast.stmt]:
    """All statements that run, however deep they are."""
    found: list[ast.stmt] = []
    todo = list(body)
    while todo:
        node = todo.pop()
        found.append(node)
        if not hasattr(node, "body") and not hasattr(node, "cases"):
            continue
        if not (isinstance(node, ast.If) and _for_types(node)):
            todo += getattr(node, "body", ())
        for part in (*getattr(node, "handlers", ()), *getattr(node, "cases", ())):
            todo += part.body
        todo += getattr(node, "orelse", ())
        todo += getattr(node, "finalbody", ())
    return found


def _for_types(node: ast.If) -> bool:
    return getattr(node.test, "attr", getattr(node.test, "id", "")) == "TYPE_CHECKING"


def _imports(node: ast.stmt) -> Iterator[Import]:
    match node:
        case ast.Import():
            for alias in node.names:
                yield Import(0, alias.name)
                if alias.asname is None and "." in alias.name:  # binds the first package, whose names can be used
                    yield Import(0, alias.name.partition(".")[0])
        case ast.ImportFrom():
            for alias in node.names:
                yield Import(node.level, node.module or "", alias.name)


def _finding_calls(text: str, tree: ast.Module) -> Iterator[ast.Call]:
    """Calls that import a module by its name."""
    if any(name in text for name in FINDERS):
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in FINDERS:
                yield node


def _constant(node: ast.Call) -> Import | None:
    """What a call of ``import_module`` imports; None if its name is computed."""
    match node.args:
        case [ast.Constant(value=str(name)), *_]:
            plain = name.lstrip(".")
            return Import(len(name) - len(plain), plain)
    return None


def _bound(node: ast.stmt) -> Iterator[str]:
    match node:
        case ast.Import() | ast.ImportFrom():
            yield from (alias.asname or alias.name.partition(".")[0] for alias in node.names)
        case ast.FunctionDef() | ast.ClassDef() | ast.AsyncFunctionDef():
            yield node.name
        case ast.Assign() | ast.AnnAssign():
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (target.id for target in targets if isinstance(target, ast.Name))


def _is_end(node: ast.stmt) -> bool:
    match node:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Constant(value=True)) if name == END:
            return True
    return False
