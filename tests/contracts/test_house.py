"""The house: no circle of imports, no arrow against the order of its rooms, no name for two things."""

import ast
import functools
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("dincl", "meanfield", "tissue", "verification")
# room -> rooms of the same package that its files must not import, at any depth.
CLOSED = {
    "verification": {"": ("thesis",), "page": ("thesis",)},
}
# Files that bring rooms together: the command line finds the source that is verified.
DOORS = {"verification.cli"}


@functools.cache
def modules() -> dict[str, Path]:
    """All modules of the packages, by dotted name."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imported(name: str) -> set[str]:
    """The modules that one imports: at its top or inside of functions, for types, too."""
    found = set()
    for node in ast.walk(ast.parse(modules()[name].read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            inside = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= inside & modules().keys() if inside & modules().keys() else {node.module}
    return (found & modules().keys()) - {name}


def faces() -> set[str]:
    """Packages' __init__ files: they hand names on, and are no rooms."""
    return {name for name, path in modules().items() if path.name == "__init__.py"}


def circles() -> list[list[str]]:
    """Groups of modules that import each other, by Tarjan's algorithm."""
    arrows = {name: imported(name) - faces() for name in modules() if name not in faces()}
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(name: str) -> None:
        index[name] = low[name] = len(index)
        stack.append(name)
        for other in arrows[name]:
            if other not in index:
                visit(other)
                low[name] = min(low[name], low[other])
            elif other in stack:
                low[name] = min(low[name], index[other])
        if low[name] == index[name]:
            group = stack[stack.index(name) :]
            del stack[stack.index(name) :]
            if len(group) > 1:
                found.append(sorted(group))

    for name in arrows:
        if name not in index:
            visit(name)
    return found


@pytest.mark.slow
def test_no_module_imports_itself_through_others() -> None:
    assert circles() == []


@pytest.mark.parametrize("package", CLOSED)
def test_arrows_inside_a_package(package: str) -> None:
    wrong = []
    for name in modules():
        parts = name.split(".")
        room = parts[1] if len(parts) > 2 else ""
        if parts[0] != package or room not in CLOSED[package] or name in DOORS:
            continue
        for other in imported(name):
            target = other.split(".")
            if target[0] == package and len(target) > 1 and target[1] in CLOSED[package][room]:
                wrong.append(f"{name} -> {other}")
    assert wrong == []


@pytest.mark.slow
def test_no_two_public_classes_share_a_name() -> None:
    places = defaultdict(list)
    for name, path in modules().items():
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(name)
    assert {name: where for name, where in places.items() if len(where) > 1} == {}
