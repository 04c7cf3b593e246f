"""Kernels take numbers only from modules whose code is in the key of cached machine code."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from dincl.compiled.folders import FOLDERS, holds_kernels, require_folder

ROOT = Path(__file__).parents[3]
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for package in ("dincl", "meanfield", "tissue", "verification")
    for path in (ROOT / package).rglob("*.py")
}
ROOM = "dincl.compiled"
DECORATORS = {"kernel", "inner", "allocating", "c_function"}
# Private parts of numba that need no import: attributes of our functions, and hooks of Python.
PRIVATE = re.compile(r"_numba_type_|\._compile_for_args|\bget_call_template\b|\b_nrt\b|unraisablehook|numba\.config")
# Modules with kernels import these for their Python functions, none of which is compiled.
FOR_PYTHON = {"dincl.callables", "dincl.checks", "dincl.errors", "dincl.status", "tissue.runs.run"}
FOR_PYTHON |= {"tissue.runs.user_code"}


@cache
def body(name: str) -> list[ast.stmt]:
    return ast.parse(MODULES[name].read_text("utf-8")).body


def imported(name: str) -> dict[str, str]:
    """Map each name that a module imports from our packages, when it is loaded, to its module."""
    pairs = [
        (alias.asname or alias.name, node.module or "", alias.name)
        for node in body(name)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]
    found = {
        name: f"{module}.{inside}" if f"{module}.{inside}" in MODULES else module for name, module, inside in pairs
    }
    return {name: module for name, module in found.items() if module in MODULES}


def names_in(*nodes: ast.AST) -> set[str]:
    return {inner.id for node in nodes for inner in ast.walk(node) if isinstance(inner, ast.Name)}


def compiled(name: str) -> list[ast.FunctionDef]:
    functions = [node for node in body(name) if isinstance(node, ast.FunctionDef)]
    ours = {alias for alias, module in imported(name).items() if module.startswith((ROOM, "tissue.kernels"))}
    return [one for one in functions if DECORATORS & ours & names_in(*one.decorator_list)]


def with_kernels() -> set[str]:
    """Name the modules with compiled functions, and the modules that these import from the folders."""
    todo = [name for name in MODULES if compiled(name) or name.startswith("tissue.events.")]
    found: set[str] = set()
    while todo:
        name = todo.pop()
        if name not in found:
            found.add(name)
            todo += [module for module in imported(name).values() if holds_kernels(module)]
    return {name for name in found if not name.startswith(ROOM)}


def test_the_folders_exist_and_hold_all_kernels() -> None:
    assert set(FOLDERS) <= MODULES.keys()
    assert [name for name in MODULES if compiled(name) and not holds_kernels(name)] == []


def test_kernels_use_only_what_the_folders_hold() -> None:
    for name in with_kernels():
        away = {alias: module for alias, module in imported(name).items() if not holds_kernels(module)}
        assert set(away.values()) <= FOR_PYTHON, name
        values = [node.value for node in body(name) if isinstance(node, ast.Assign | ast.AnnAssign) and node.value]
        assert names_in(*compiled(name), *values).isdisjoint(away), name


def test_private_parts_of_numba_are_used_in_one_folder() -> None:
    outside = {name: path for name, path in MODULES.items() if not f"{name}.".startswith(f"{ROOM}.")}
    assert [name for name, path in outside.items() if PRIVATE.search(path.read_text("utf-8"))] == []


def test_a_kernel_in_another_folder_is_refused() -> None:
    def stray() -> None: ...

    stray.__module__ = "dincl.plotting.arrows"
    with pytest.raises(RuntimeError, match=r"dincl\.plotting\.arrows compiles stray: add its folder"):
        require_folder(stray)
