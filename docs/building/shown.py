"""Pages with Python: tutorials, how-to pages and explanations, with outputs of their notebooks and links to these.

``python -m docs.building.shown`` runs the notebooks of pages that changed; the site shows the outputs of the others.
"""

from __future__ import annotations

import os
import re
import tempfile
from contextlib import chdir
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat

from docs.building.notebooks import notebook, run

if TYPE_CHECKING:
    from nbformat import NotebookNode

BLOCK = re.compile(r"^```(python|sh)\n.*?^```\n", re.MULTILINE | re.DOTALL)
PYTHON = "\n```python\n"
DOCS = Path(__file__).parents[1]
NOTEBOOKS = DOCS / "made" / "notebooks"
FOLDERS = ("tutorials", "howto", "explain")
DOWNLOAD = "\n\n[Download this page as a notebook]({link})\n"


def is_notebook(page: Path) -> bool:
    """Return whether a page is a notebook, too: a tutorial, a how-to page or an explanation with Python."""
    return page.parent.name in FOLDERS and PYTHON in page.read_text("utf-8")


def run_all() -> None:
    """Run the notebooks of pages that changed."""
    NOTEBOOKS.mkdir(parents=True, exist_ok=True)
    for page in filter(is_notebook, sorted(DOCS.rglob("*.md"))):
        if _ran(page) is None:
            made = notebook(page)
            with tempfile.TemporaryDirectory() as folder, chdir(folder):
                run(made)
            nbformat.write(made, _file(page))


def with_outputs(page: Path) -> str:
    """Return a page with the outputs of its notebook and a link to it; the page alone if it changed after that ran."""
    text, made = page.read_text("utf-8"), _ran(page)
    if made is None:
        return text
    ran = (cell for cell in made.cells if cell.cell_type == "code" and not cell.source.startswith("%%writefile"))
    text = BLOCK.sub(lambda block: block.group() + "".join(map(_one, next(ran).outputs)), text)
    title, _, rest = text.partition("\n")
    return f"{title}{DOWNLOAD.format(link=os.path.relpath(_file(page), page.parent))}{rest}"


def _file(page: Path) -> Path:
    return NOTEBOOKS / f"{page.stem}.ipynb"


def _ran(page: Path) -> NotebookNode | None:
    """Return the notebook of a page that was run, unless the page changed."""
    if not (file := _file(page)).exists():
        return None
    made = nbformat.read(file, as_version=4)
    same = [cell.source for cell in made.cells] == [cell.source for cell in notebook(page).cells]
    return made if same else None


def _one(output: Any) -> str:
    if output.output_type == "stream":
        return f"\n```{{code-block}} text\n:class: output\n\n{output.text.rstrip()}\n```\n"
    data = output.data
    if "image/png" in data:
        html = f'<img alt="What the code above draws" src="data:image/png;base64,{data["image/png"]}">'
    elif "text/html" in data:
        html = re.sub(r"<style.*?</style>", "", data["text/html"], flags=re.DOTALL)
    else:
        return f"\n```{{code-block}} text\n:class: output\n\n{data['text/plain']}\n```\n"
    return f'\n````{{raw}} html\n<div class="output">{html}</div>\n````\n'


if __name__ == "__main__":
    run_all()
