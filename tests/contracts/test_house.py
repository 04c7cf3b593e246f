"""Contract of the rooms: imports run down the order of rooms, no circles, no class name used twice.

A room is a folder of modules, or a module at the root of a package. A module may import from its own room and from
rooms below. Imports that run count, also those inside functions. Imports under ``if TYPE_CHECKING:`` never run, so they
may go up and close circles.
"""

import ast
import functools
from collections import Counter, defaultdict
from collections.abc import Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOP = "(public names)"  # the __init__ file at the root of a package
# The rooms of each package, lowest first; a line of this table may hold several.
ORDER = {
    "dincl": (
        "constants errors status work norms files conversions checks extras callables",
        "provenance study compiled matrices drifts rows neighbours constraints shapes region drawing",
        "plotting problem solvers system steps projection minimise geometry scenes trajectory",
        "events schemes solve",
    ),
    "meanfield": (
        "errors weights plotting density model forces transport solvers solvers.grid",
    ),
    "tissue": (
        "plugins state kernels network model rules step events frames files statistics pictures runs quasi_steady",
        "study study.figures cli",
    ),
    "verification": (
        "claims formal pytest_plugin page proofs instruments explore.common explore.inclusions explore.tissues explore",
        "beyond.chart.baselines thesis.text thesis.introduction thesis.conclusions thesis.appendix",
        "thesis.chapter1 thesis.chapter2 thesis.chapter2.stability",
        "thesis.chapter3 thesis.chapter3.sections thesis.chapter4 thesis.chapter5 thesis.chapter5.sections",
        "thesis.appendix.claims thesis.chapter1.claims thesis.chapter2.claims thesis.chapter3.claims",
        "thesis.chapter4.claims thesis.chapter5.claims thesis.conclusions.claims thesis.introduction.claims",
        "beyond.moving beyond.proved beyond.decisions beyond.chart beyond.iterations beyond.curved beyond.space",
        "beyond.space.sections beyond.needs beyond thesis cli command",
    ),
}  # fmt: skip
# Imports that go up today: (importing room, imported room) -> number of imports. The lists may only shrink.
UPWARD = {
    "dincl": {},
    "meanfield": {},
    "tissue": {},
    "verification": {},
}
# Circles of rooms today: each line one circle. These lists may only shrink, too.
CIRCLES = {
    "dincl": (),
    "meanfield": (),
    "tissue": (),
    "verification": (),
}


@functools.cache
def modules() -> dict[str, Path]:
    """List all modules of the packages, by dotted name."""
    found = {}
    for package in ORDER:
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def is_package(name: str) -> bool:
    """Return whether a module is the __init__ file of a folder."""
    return modules()[name].name == "__init__.py"


def room(name: str) -> str:
    """Return the room of a module, as ORDER names it."""
    _, *inside = name.split(".")
    if not inside:
        return TOP
    return ".".join(inside if is_package(name) else inside[:-1] or inside)


def order(package: str) -> list[str]:
    """List the rooms of a package, lowest first."""
    return [*" ".join(ORDER[package]).split(), TOP]


@functools.cache
def tree(name: str) -> ast.Module:
    """Parse a module."""
    return ast.parse(modules()[name].read_text("utf-8"))


@functools.cache
def imported(name: str) -> frozenset[str]:
    """List the modules that a module imports when it runs, at its top or inside functions."""
    found: set[str] = set()
    waiting: list[ast.AST] = [tree(name)]
    while waiting:
        match waiting.pop():
            case ast.If(test=ast.Name(id="TYPE_CHECKING"), orelse=otherwise):
                waiting += otherwise
            case ast.Import(names=names):
                found |= {alias.name for alias in names}
            case ast.ImportFrom(module=str(module), names=names):
                inside = {f"{module}.{alias.name}" for alias in names}
                found |= {full if full in modules() else module for full in inside}
            case node:
                waiting += ast.iter_child_nodes(node)
    return frozenset((found & modules().keys()) - {name})


def arrows(package: str) -> Counter[tuple[str, str]]:
    """Count the imports from each room of a package to each other room."""
    found: Counter[tuple[str, str]] = Counter()
    for name in modules():
        if name.split(".")[0] == package:
            inside = (room(other) for other in imported(name) if other.split(".")[0] == package)
            found.update((room(name), other) for other in inside if other != room(name))
    return found


def circles(targets: Mapping[str, set[str]]) -> list[set[str]]:
    """Find the groups of nodes that reach each other, by Tarjan's algorithm."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[set[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in targets[node]:
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            group = set(stack[stack.index(node) :])
            del stack[stack.index(node) :]
            if len(group) > 1:
                found.append(group)

    for node in targets:
        if node not in index:
            visit(node)
    return found


@pytest.mark.slow
def test_no_module_imports_itself_through_others() -> None:
    # An __init__ file passes names of its folder on to others; its imports are those of the whole folder.
    named = [name for name in modules() if not is_package(name)]
    assert circles({name: set(imported(name)) & set(named) for name in named}) == []


@pytest.mark.slow
@pytest.mark.parametrize("package", ORDER)
def test_the_order_names_all_rooms(package: str) -> None:
    rooms = order(package)
    assert len(rooms) == len(set(rooms))
    # A folder whose only module is an empty __init__ file, such as one that holds folders, may be left out.
    used = {room(n) for n in modules() if n.split(".")[0] == package and (not is_package(n) or imported(n))}
    assert used <= set(rooms), "rooms that the table ORDER does not have"
    assert set(rooms) <= {room(n) for n in modules() if n.split(".")[0] == package}, "rooms that no longer exist"


@pytest.mark.slow
@pytest.mark.parametrize("package", ORDER)
def test_imports_run_down_the_order_of_rooms(package: str) -> None:
    height = {name: k for k, name in enumerate(order(package))}
    upward = {pair: n for pair, n in arrows(package).items() if height[pair[0]] < height[pair[1]]}
    assert upward == UPWARD[package], "imports that go up; fewer than listed: shorten the list"


@pytest.mark.slow
@pytest.mark.parametrize("package", ORDER)
def test_circles_of_rooms_are_known(package: str) -> None:
    targets: dict[str, set[str]] = {name: set() for name in order(package)}
    for importing, target in arrows(package):
        targets[importing].add(target)
    assert {" ".join(sorted(group)) for group in circles(targets)} == set(CIRCLES[package])


@pytest.mark.slow
def test_no_two_public_classes_share_a_name() -> None:
    places = defaultdict(list)
    for name in modules():
        for node in tree(name).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(name)
    assert {name: where for name, where in places.items() if len(where) > 1} == {}
