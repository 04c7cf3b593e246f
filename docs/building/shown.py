"""Pages with Python: tutorials, how-to pages and explanations, with outputs of their notebooks and links to these."""

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
FOLDERS = ("tutorials", "howto", "explain")
DOWNLOAD = "\n\n[Download this page as a notebook]({link})\n"


def is_notebook(page: Path) -> bool:
    """Return whether a page is a notebook, too: a tutorial, a how-to page or an explanation with Python."""
    return page.parent.name in FOLDERS and PYTHON in page.read_text("utf-8")


def with_outputs(page: Path, notebooks: Path) -> str:
    """Run the notebook of a page, write it into a folder; the page with a link to it and its outputs."""
    made = notebook(page)
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        run(made)
    notebooks.mkdir(parents=True, exist_ok=True)
    file = notebooks / f"{page.stem}.ipynb"
    nbformat.write(made, file)
    ran = (cell for cell in made.cells if cell.cell_type == "code" and not cell.source.startswith("%%writefile"))
    text = BLOCK.sub(lambda block: block.group() + _shown(next(ran)), page.read_text("utf-8"))
    title, _, rest = text.partition("\n")
    return f"{title}{DOWNLOAD.format(link=os.path.relpath(file, page.parent))}{rest}"


def _shown(cell: NotebookNode) -> str:
    return "".join(map(_one, cell.outputs))


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
