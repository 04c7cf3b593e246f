"""Pages with Python as notebooks: made from their text, and run.

A notebook has what its page has: the Python, the files that the page tells its reader to write, and the commands. It is
run by IPython, as Jupyter does, in the process at hand and in a namespace of its own: a kernel for each of them would
import all libraries anew.
"""

from __future__ import annotations

import atexit
import base64
import io
import re
import shlex
import sys
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import TYPE_CHECKING, Any

import jupytext
import matplotlib as mpl
import nbformat
import pytest
from IPython.core.displayhook import CapturingDisplayHook
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
from matplotlib import pyplot as plt
from traitlets.config import Config
from typer.testing import CliRunner

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nbformat import NotebookNode

mpl.use("Agg")
# "Write this to `NAME`:" and the block behind it.
FILE = re.compile(r"(Write this to\s`([\w.]+)`:\n\n)```\w+\n")
HEAD = """---
jupyter:
  kernelspec:
    display_name: Python 3
    language: python
    name: python3
---
"""


def notebook(page: Path) -> NotebookNode:
    """The notebook of a page; files are written by its cells, commands are run by them."""
    made = jupytext.reads(HEAD + FILE.sub(r"\1```python\n%%writefile \2\n", page.read_text("utf-8")), fmt="md")
    for number, cell in enumerate(made.cells):
        cell.id = str(number)
    return made


def run(made: NotebookNode) -> dict[str, Any]:
    """Run all cells in the folder at hand, give them their outputs; what they leave.

    Raises
    ------
    RuntimeError
        If a cell fails; with its text.
    """
    with TemporaryDirectory() as home, _shell(home) as shell:
        code = [cell for cell in made.cells if cell.cell_type == "code"]
        for count, cell in enumerate(code, start=1):
            values: list[dict[str, Any]] = []
            shell.display_trap.hook = CapturingDisplayHook(shell, values)
            with capture_output(display=False) as caught:
                done = shell.run_cell(cell.source, store_history=False)
            if not done.success:
                raise RuntimeError(f"{cell.source}\n{caught.stdout}{caught.stderr}") from done.error_in_exec
            cell.execution_count, cell.outputs = count, [*_outputs(caught.stdout, values), *_figures()]
        return dict(shell.user_ns)


def printed(made: NotebookNode) -> str:
    """All text that the cells of a notebook have put out."""
    outputs = [output for cell in made.cells if cell.cell_type == "code" for output in cell.outputs]
    return "".join(output["text"] if "text" in output else output["data"].get("text/plain", "") for output in outputs)


@contextmanager
def _shell(home: str) -> Iterator[InteractiveShell]:
    """A shell that finds modules in the folder at hand, as Jupyter does; they are forgotten at the end."""
    here, known = str(Path.cwd()), set(sys.modules)
    plain = Config({"InteractiveShell": {"colors": "nocolor", "xmode": "Plain"}, "HistoryManager": {"enabled": False}})
    shell = InteractiveShell.instance(user_module=ModuleType("page"), ipython_dir=home, config=plain)
    shell.register_magic_function(_commands, "cell", "sh")
    sys.path.insert(0, here)
    try:
        yield shell
    finally:
        sys.path.remove(here)
        plt.close("all")
        for name in set(sys.modules) - known:
            # Libraries stay, also where their environment lies in the folder at hand.
            file = str(getattr(sys.modules[name], "__file__", ""))
            if name == "page" or (file.startswith(here) and not file.startswith(sys.prefix)):
                del sys.modules[name]
        InteractiveShell.clear_instance()
        atexit.unregister(shell.atexit_operations)  # it would keep all that a page leaves until the process ends


def _commands(line: str, cell: str) -> None:
    """Run each line in this process."""
    for words in map(shlex.split, cell.splitlines()):
        print(_output(*words), end="")


def _output(program: str, *arguments: str) -> str:
    import tissue.cli.app
    import verification.cli

    if program == "pytest":
        with capture_output() as caught:
            failed = pytest.main([*arguments, "-p", "no:cacheprovider", "-p", "no:faulthandler"])
        text = caught.stdout
    else:
        app = {"tissue": tissue.cli.app.app, "verification": verification.cli.app}[program]
        done = CliRunner().invoke(app, arguments)
        text, failed = done.output, done.exit_code
    if failed:
        raise RuntimeError(f"{shlex.join((program, *arguments))}\n{text}")
    return text


def _outputs(text: str, values: list[dict[str, Any]]) -> list[NotebookNode]:
    """What a cell prints, and the value of its last line."""
    printed_text = [nbformat.v4.new_output("stream", name="stdout", text=text)] if text else []
    return printed_text + [nbformat.v4.new_output("display_data", **value) for value in values]


def _figures() -> list[NotebookNode]:
    """What was drawn, as the kernel of Jupyter shows it."""
    found = []
    for number in plt.get_fignums():
        picture = io.BytesIO()
        plt.figure(number).savefig(picture, dpi=100)
        data = {"image/png": base64.b64encode(picture.getvalue()).decode()}
        found.append(nbformat.v4.new_output("display_data", data=data))
    plt.close("all")
    return found
