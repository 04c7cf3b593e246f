"""The rooms of the package: which imports which, and that no file imports itself by way of others."""

from __future__ import annotations

import ast
from graphlib import TopologicalSorter
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "meanfield"
# What each room may import besides itself, kernels and errors: those who only annotate a type count, too.
MAY_IMPORT = {
    "model": set(),
    "density": set(),
    "transport": {"density"},
    "forces": {"model"},
    "solvers": {"model", "forces", "density", "transport", "plotting"},
    "kernels": set(),
    "errors": set(),
    "plotting": set(),
}


def arrows() -> dict[str, set[str]]:
    """The files of the package that each file imports."""
    names = {".".join(("meanfield", *path.relative_to(PACKAGE).with_suffix("").parts)) for path in sources()}
    found: dict[str, set[str]] = {}
    for path in sources():
        imports: set[str] = set()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("meanfield"):
                imports |= {node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)}
        found[".".join(("meanfield", *path.relative_to(PACKAGE).with_suffix("").parts))] = imports & names
    return found


def sources() -> list[Path]:
    """The files that define something."""
    return [path for path in sorted(PACKAGE.rglob("*.py")) if path.name != "__init__.py"]


def test_no_circle():
    order = list(TopologicalSorter(arrows()).static_order())
    assert "meanfield.model.model" in order


def test_rooms_import_one_way():
    wrong = [
        (name, other)
        for name, others in arrows().items()
        for other in others
        if (room := name.split(".")[1]) != (there := other.split(".")[1])
        and there not in MAY_IMPORT[room] | {"kernels", "errors"}
    ]
    assert wrong == []
    assert {name.split(".")[1] for name in arrows()} == MAY_IMPORT.keys()
