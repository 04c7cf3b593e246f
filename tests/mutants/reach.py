"""The files of tests that reach a module, nearest first, from the import statements."""

import ast
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
# Tests of the text of sources, of other folders than this one, and of whole programs: they would be slow to tell.
LEFT_OUT = ("contracts", "users", "mutants", "explore")


@cache
def tree(path: Path) -> ast.Module:
    """The syntax tree of a file."""
    return ast.parse(path.read_text("utf-8"))


@cache
def identifiers(path: Path) -> frozenset[str]:
    """All names and attributes in a file."""
    found = (getattr(node, "attr", getattr(node, "id", "")) for node in ast.walk(tree(path)))
    return frozenset(found)


def file_of(module: str) -> Path | None:
    """The file of a module of this tree."""
    place = ROOT.joinpath(*module.split("."))
    return next((path for path in (place.with_suffix(".py"), place / "__init__.py") if path.is_file()), None)


@cache
def imported(path: Path) -> tuple[tuple[str, Path], ...]:
    """The names that a file imports, and the files where they are looked for: of a computed name, the whole folder."""
    found: list[tuple[str, Path | None]] = []
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            found += [(alias.name, file_of(alias.name)) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [alias.name for alias in node.names]
            found += [(name, file_of(f"{node.module}.{name}") or file_of(node.module)) for name in names]
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "import_module":
            found += [("", file) for file in path.parent.glob("*.py") if isinstance(node.args[0], ast.JoinedStr)]
    return tuple((name, file) for name, file in found if file is not None)


def used(path: Path) -> set[Path]:
    """The files that a file uses: a package hands on those names that are written in the file."""
    files: set[Path] = set()
    todo = [file for _, file in imported(path)]
    while todo:
        file = todo.pop()
        if file not in files and file.name == "__init__.py":
            todo += [inner for name, inner in imported(file) if name in identifiers(path)]
        files.add(file)
    return {file for file in files if file.name != "__init__.py"}


@cache
def users() -> dict[Path, set[Path]]:
    """The files of the tree that use a file."""
    found: dict[Path, set[Path]] = defaultdict(set)
    for folder in ("dincl", "meanfield", "tissue", "verification", "tests"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            for file in used(path) if path.name != "__init__.py" else ():
                found[file].add(path)
    return found


def tests_of(module: Path) -> list[Path]:
    """The files of tests that reach a module: by the number of imports between, then by common folders."""
    distance, front = {module: 0}, [module]
    while front:
        after = {user for file in front for user in users()[file]} - distance.keys()
        distance |= dict.fromkeys(after, distance[front[0]] + 1)
        front = sorted(after)
    mirrored = set(module.relative_to(ROOT).with_suffix("").parts)

    def rank(test: Path) -> tuple[int, int, str]:
        words = {*test.relative_to(ROOT).parts, *test.stem.split("_")}
        return distance[test], -len(mirrored & words), str(test)

    reached = (path for path in distance if path.name.startswith("test_"))
    return sorted((path for path in reached if not {*path.parts} & {*LEFT_OUT}), key=rank)
