"""The command ``tissue figures``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tissue.cli.messages import messages

MAKES_NO_NUMBERS = True

Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study, or a folder with such folders in it.")]


def figures(folder: Folder) -> None:
    """Draw the counterparts of Figures 10 to 22 of chapter 4, as far as there are results, into DIR/figures.

    A line for each says from what it was drawn, or which study it lacks, with the command that makes it.
    """
    from tissue.study.figures.catalogue import draw_all

    with messages():
        for one in draw_all(folder):
            files = f"{one.files[0]} and {one.files[1].suffix}, from" if one.files else one.name
            print(f"{files} {one.told}", flush=True)
