"""Pages in Markdown as tests read them: their blocks; tutorials as notebooks."""

import re
from contextlib import chdir
from pathlib import Path

from docs.building.notebooks import notebook, printed
from docs.building.notebooks import run as run_cells

ROOT = Path(__file__).parents[1]


def blocks(text: str, language: str) -> list[str]:
    """The blocks of a language, in their order."""
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def run(page: Path) -> dict:
    """Run the Python of a page from top to bottom; return what it leaves."""
    scope = {"__name__": "page"}
    for block in blocks(page.read_text("utf-8"), "python"):
        exec(compile(block, str(page), "exec"), scope)
    return scope


def play(page: Path, folder: Path) -> dict:
    """Run the notebook of a page in a folder; what it leaves, and what it prints by the name "printed"."""
    made = notebook(page)
    with chdir(folder):
        return run_cells(made) | {"printed": printed(made)}
