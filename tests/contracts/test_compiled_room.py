"""Names of numba and llvmlite are used in dincl/compiled alone, and kernels take numbers from keyed folders only."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from dincl.compiled.folders import FOLDERS, holds_kernels, require_folder

ROOT = Path(__file__).parents[2]
PACKAGES = ("dincl", "meanfield", "tissue", "verification")
ROOM = "dincl.compiled"
COMPILERS = {"numba", "llvmlite"}
# What a part of numba looks like that is not imported: its attributes on our functions, and hooks of Python.
INSIDES = re.compile(r"_numba_type_|\._compile_for_args|\bget_call_template\b|\b_nrt\b|unraisablehook|numba\.config")
DECORATORS = {"kernel", "inner", "allocating", "c_function"}
# Imported by modules with kernels for their Python functions, none of which is compiled.
FOR_PYTHON = {"dincl.callables", "dincl.checks", "dincl.errors", "dincl.status"}
FOR_PYTHON |= {"tissue.runs.run", "tissue.runs.user_code"}


@cache
def modules() -> dict[str, Path]:
    """All modules of the packages."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def tree(name: str) -> ast.Module:
    return ast.parse(modules()[name].read_text("utf-8"))


def outside() -> list[str]:
    return [name for name in modules() if name != ROOM and not name.startswith(f"{ROOM}.")]


def loaded(body: list[ast.stmt]) -> list[ast.stmt]:
    """The statements of a module that are executed when it is imported."""
    found: list[ast.stmt] = []
    for node in body:
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        found += [node, *loaded([*getattr(node, "body", ())])] if isinstance(node, ast.If | ast.Try) else [node]
    return found


def imported(name: str) -> dict[str, str]:
    """Of each name that a module imports from the packages at run time: which module it is, or is from."""
    found = {}
    for node in loaded(tree(name).body):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inside = f"{node.module}.{alias.name}"
                found[alias.asname or alias.name] = inside if inside in modules() else node.module
        elif isinstance(node, ast.Import):
            found |= {alias.asname or alias.name: alias.name for alias in node.names}
    return {alias: module for alias, module in found.items() if module in modules()}


def compiled(name: str) -> list[ast.FunctionDef]:
    """The functions of a module with one of the decorators."""
    rooms = (ROOM, "tissue.kernels")
    room = {alias for alias, module in imported(name).items() if module.startswith(rooms)}
    functions = [node for node in tree(name).body if isinstance(node, ast.FunctionDef)]
    functions = functions if room & DECORATORS else []
    return [one for one in functions if DECORATORS & {n.id for d in one.decorator_list for n in names_in(d)}]


def names_in(node: ast.AST) -> list[ast.Name]:
    return [inner for inner in ast.walk(node) if isinstance(inner, ast.Name)]


def with_kernels() -> set[str]:
    """The modules with compiled functions, and those in the folders that these import, directly or through others."""
    todo = [name for name in modules() if compiled(name) or name.startswith("tissue.events.")]
    found: set[str] = set()
    while todo:
        name = todo.pop()
        if name not in found:
            found.add(name)
            todo += [module for module in imported(name).values() if holds_kernels(module)]
    return {name for name in found if not name.startswith(ROOM)}


@pytest.mark.parametrize("package", PACKAGES)
def test_no_other_room_imports_a_compiler(package: str) -> None:
    wrong = set()
    for name in outside():
        if name.split(".")[0] == package:
            for node in ast.walk(tree(name)):
                tops = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
                tops += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                wrong |= {name for top in tops if top.partition(".")[0] in COMPILERS}
    assert wrong == set()


def test_no_other_room_touches_what_may_change() -> None:
    texts = {name: modules()[name].read_text("utf-8") for name in outside()}
    assert {name: found[0] for name, text in texts.items() if (found := INSIDES.search(text))} == {}


def test_one_module_hooks_into_python() -> None:
    room = [path for path in (ROOT / "dincl" / "compiled").glob("*.py") if "unraisablehook" in path.read_text("utf-8")]
    assert [path.name for path in room] == ["uncaught.py"]


def test_folders_exist_and_hold_kernels() -> None:
    for folder in FOLDERS:
        assert folder in modules(), folder
    assert {name for name in modules() if compiled(name) and not holds_kernels(name)} == set()


def test_kernels_take_numbers_from_the_folders_alone() -> None:
    wrong = {}
    for name in with_kernels():
        away = {alias: module for alias, module in imported(name).items() if not holds_kernels(module)}
        wrong[name] = {f"{alias} of {module}" for alias, module in away.items() if module not in FOR_PYTHON}
    assert {name: found for name, found in wrong.items() if found} == {}


def test_what_is_imported_for_python_is_not_in_kernels() -> None:
    wrong = {}
    for name in with_kernels():
        away = {alias for alias, module in imported(name).items() if module in FOR_PYTHON}
        given = [node.value for node in tree(name).body if isinstance(node, ast.Assign | ast.AnnAssign)]
        constants = [value for value in given if value is not None]
        used = {one.id for node in [*compiled(name), *constants] for one in names_in(node)}
        wrong[name] = used & away
    assert {name: found for name, found in wrong.items() if found} == {}


def test_a_kernel_in_another_folder_is_refused() -> None:
    def stray() -> None: ...

    stray.__module__ = "dincl.plotting.arrows"
    with pytest.raises(RuntimeError, match=r"dincl\.plotting\.arrows compiles stray: add its folder"):
        require_folder(stray)
