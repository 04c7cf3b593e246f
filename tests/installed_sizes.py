"""Sizes of what is installed: ``python -m tests.installed_sizes`` measures each extra, and each target of the Makefile.

It writes ``docs/howto/installed.csv`` and the table of ``docs/howto/install.md``. All extras are installed from a wheel
into an empty environment; an extra is as large as its packages and those that they need. The targets are made one after
the other in a clone of the last commit. Versions are those of the lock file.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import Distribution, distributions
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.installing import ROOT, build_wheels, copy_sources, for_users, installed, size, size_of

FILE, PAGE = ROOT / "docs/howto/installed.csv", ROOT / "docs/howto/install.md"
TARGETS = {"make report": "thesis", "make test": "test", "make everything": "dev"}
CORE = "no extra"
BRINGS = {
    CORE: "problems and all schemes",
    "report": "the instruments: orders, charts of speed against accuracy, maps of stability, their pages",
    "meanfield": "particles with a macroscopic state",
    "transport": "`meanfield.w1` in two and three dimensions, with `meanfield`",
    "tissue": "runs, studies, figures and movies of tissues",
    "proofs": "interval arithmetic and computer algebra, for proved bounds",
    "yardsticks": "external programs to compare with: Ipopt, Clarabel, CVXPY, PIQP, Chipmunk; `ProjectedNewton`",
    "explore": "the page to explore, with `report` and `tissue`",
    "cluster": "studies on a Dask cluster, with `tissue`",
    "views": "views of tissues in three dimensions by VTK, with `tissue`",
    "thesis": "what `verification report` and `verification claims` need, beside the tables",
    "all": "all of these",
}


def of_extras(folder: Path) -> dict[str, float]:
    """Install all in an environment, and return the size of each extra with what it needs [MB]."""
    wheel, _ = build_wheels(copy_sources(folder / "tree"), folder / "out")
    commands, _ = installed(sys.executable, "all", wheel, folder)
    (packages,) = commands.parent.glob("lib/python*/site-packages")
    there = {canonicalize_name(found.name): found for found in distributions(path=[str(packages)])}
    needed = {extra: needed_by([f"dincl-testbed[{extra}]"], there) for extra in for_users()}
    needed = {CORE: needed_by(["dincl-testbed"], there), **needed}
    return {extra: size_of(file for name in names for file in files_of(there[name])) for extra, names in needed.items()}


def files_of(found: Distribution) -> Iterator[Path]:
    """Give the files that a distribution installed, the bytecode of its modules among them."""
    yield from (Path(str(found.locate_file(file))) for file in found.files or ())


def needed_by(wanted: Iterable[str], there: dict[str, Distribution]) -> set[str]:
    """Return the names of the distributions that requirements need, themselves among them."""
    todo, done = [Requirement(text) for text in wanted], set[str]()
    while todo:
        one = todo.pop()
        if str(one) in done:
            continue
        done.add(str(one))
        needed = [Requirement(text) for text in there[canonicalize_name(one.name)].requires or ()]
        extras = {"", *one.extras}
        todo += [it for it in needed if not it.marker or any(it.marker.evaluate({"extra": name}) for name in extras)]
    return {canonicalize_name(Requirement(text).name) for text in done}


def of_targets(folder: Path) -> dict[str, float]:
    """Return the size of the environment of a clone after each target, one after the other [MB]."""
    subprocess.run(["git", "clone", "--quiet", ROOT, folder / "clone"], check=True)
    found = {}
    for target, extra in TARGETS.items():
        command = ["make", "--silent", f"PYTHON={sys.executable}", f".venv/{extra}"]
        subprocess.run(command, cwd=folder / "clone", check=True)
        found[target] = size(folder / "clone/.venv")
    return found


def lines(table: pd.DataFrame) -> str:
    """Write the rows of the page, one for each extra."""
    found = dict(zip(table["installed"], table["megabytes"], strict=True))
    return "\n".join(f"| {name} | {brings} | {found[name]} |" for name, brings in BRINGS.items())


def main() -> None:
    """Measure all, and write the table and the page."""
    with TemporaryDirectory() as folder:
        write(of_extras(Path(folder)) | of_targets(Path(folder)))


def write(sizes: Mapping[str, float]) -> None:
    """Write the table, and its rows into the page."""
    table = pd.DataFrame({"installed": sizes.keys(), "megabytes": [round(megabytes) for megabytes in sizes.values()]})
    table.to_csv(FILE, index=False)
    rows = re.compile(r"(?<=\|---\|---\|---\|\n).*?(?=\n\n)", re.DOTALL)
    PAGE.write_text(rows.sub(lambda _: lines(table), PAGE.read_text("utf-8"), count=1), "utf-8")


if __name__ == "__main__":
    main()
