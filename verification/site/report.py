"""The report: complete studies that ship, pages about them, parts rerun on this machine, in one site."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Protocol

from dincl.files import write_text
from verification.site.cells import machine
from verification.site.context import Context
from verification.site.store import DATA

# The repository. Installed, the pages lie beside the tables.
ROOT = Path(__file__).parents[2]
WAITING = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="5"><title>dincl</title></head>
<body><p>The pages are being made. This page reloads every five seconds.</p></body></html>
"""


class Page(Protocol):
    """A module of results: ``run`` completes studies and fills ``context.tables``, ``show`` gives pages what they show.

    ``prepare``, if there is one, is done by one worker while others begin: two that come to the same kernels at the
    same time would both compile them.
    """

    def run(self, context: Context) -> None:
        """Complete the studies."""

    def show(self, context: Context) -> None:
        """Give tables, figures and numbers; it only reads."""


def write_report(pages: Sequence[Page], context: Context, strict: bool = False) -> Path:
    """Write the site into ``context.out``; return its first page.

    The pages are written from the complete studies that ship; then parts of these are rerun, and the pages say whether
    they agree. ``strict``: see ``build``.
    """
    index = context.out / "index.html"
    context.out.mkdir(parents=True, exist_ok=True)
    if not index.exists():
        write_text(index, WAITING)
    for page in pages:
        if prepare := getattr(page, "prepare", None):
            context.executor.submit(prepare)
    for page in pages:
        page.run(context)
        page.show(context)
    context.finish_drawings()
    with TemporaryDirectory() as read:
        context.publish(facts(context))
        build(context.out, Path(read), strict)
        if context.waiting:
            print(f"{index} is complete; parts of {len(context.waiting)} studies are rerun to compare", flush=True)
            for repeat in context.waiting:
                repeat()
            context.publish(facts(context))
            build(context.out, Path(read), strict)
    return index


def facts(context: Context) -> list[tuple[str, str]]:
    """Return what a number depends on besides the code."""
    made = "made here" if context.full else "those that ship; a part of each is made again here"
    times = "seconds of CPU time with two runs at once, after a warm-up; building of solvers included"
    return [
        ("Complete studies", f"{made} (`make report FULL=1` makes them anew)"),
        *machine(),
        ("Times", times),
    ]


def build(out: Path, read: Path, strict: bool = False) -> None:
    """Let Sphinx write the pages of the repository into a folder that has tables and figures.

    A second build with the same folder ``read`` reads only pages of results again.

    Raises
    ------
    RuntimeError
        If a page cannot be written; with ``strict`` also for a warning.
    """
    root = ROOT
    if not (root / "docs" / "conf.py").exists():  # what is installed is not written to
        root = read / "pages"
        shutil.copytree(DATA / "docs", root / "docs", dirs_exist_ok=True)
        for page in (*DATA.glob("*.md"), *DATA.glob("*.cff")):
            shutil.copy(page, root)
    command = [sys.executable, "-m", "sphinx", "-q", *(["-W"] if strict else [])]
    # In one process: in parallel Sphinx 9 loses errors of pages that it writes.
    done = subprocess.run([*command, "-c", root / "docs", "-d", read / "trees", root, out], check=False)
    if done.returncode:
        raise RuntimeError(f"the pages could not be written into {out}: see the messages of Sphinx above")
