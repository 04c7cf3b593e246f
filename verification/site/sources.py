"""Source code beside the report: a page for each module that decides claims, with an address for each line."""

from __future__ import annotations

import linecache
import sys
from pathlib import Path

from verification.site.render import render_page

FOLDER = "code"


def write_source(module: str, out: Path) -> Path:
    """Write ``<out>/code/<module>.html`` for a module that was imported; line n has the address ``#n``."""
    lines = linecache.getlines(str(sys.modules[module].__file__))
    return render_page("code.html", out / FOLDER / f"{module}.html", module=module, lines=lines)


def link(check: str) -> str:
    """Return the address of a check, ``module:line``, from the pages of the report."""
    module, line = check.split(":")
    return f"{FOLDER}/{module}.html#{line}"
