"""The command ``tissue explore``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from dincl.errors import InvalidProblem
from dincl.extras import needs
from tissue.cli.messages import messages
from tissue.files.parameter_files import PRESETS

# Without a file the page begins with some cells that may leave the tissue, so that there is an answer.
BEGIN: dict[str, Any] = {"emt.cells": 10, "emt.a": "6 h to 24 h", "emt.b": "6 h to 24 h"}

File = Annotated[
    str | None,
    typer.Argument(
        metavar="FILE",
        help=f"A parameter file, or a preset: {', '.join(PRESETS)}.",
        show_default="thesis, 10 EMT cells",
    ),
]
Root = Annotated[
    Path | None,
    typer.Option("--folder", help="All that the page may read and write.", show_default="the one of FILE, or this one"),
]
Port = Annotated[int, typer.Option(min=0, max=65535, help="0: one that is free.")]
Browser = Annotated[bool, typer.Option("--browser/--no-browser", help="Whether to open the page in a browser.")]


def explore(file: File = None, folder: Root = None, port: Port = 0, browser: Browser = True) -> None:
    """Serve a page: turn a knob, see the tissue and what becomes of its cells, with intervals from many runs.

    Its knobs are the keys that "tissue parameters" lists. Ctrl-C ends it. On a new machine it takes half a minute to
    begin: the kernels are compiled.
    """
    with messages():
        with needs("tissue explore", "explore"):
            from verification.explore.folder import Folder
            from verification.explore.server import serve

        is_file = file is not None and file not in PRESETS
        if is_file and not Path(file or "").is_file():
            raise InvalidProblem(
                f"{file}: there is no such file; must be a TOML file, or a preset: {', '.join(PRESETS)}"
            )
        kept = Folder(folder or (Path(file or "").parent if is_file else Path()))
        if is_file and Path(file or "").resolve().parent != kept.root:
            raise InvalidProblem(f"--folder {folder}: must be the folder of {file}, or be left out")
        name = Path(file).name if file is not None else "thesis"
        serve(kept, name, {} if file is not None else BEGIN, port, browser=browser)
