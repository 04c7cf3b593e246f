"""The command ``tissue figures``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tissue.cli.messages import messages

MAKES_NO_NUMBERS = True

Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study, or a folder with such folders in it.")]


def figures(folder: Folder) -> None:
    """Draw studies, each into the folder figures in its own: positions, ratios in time and at the end, examples.

    Of studies that come with the program also the counterparts of Figures 10 to 22 of chapter 4, into DIR/figures, both
    presets beside each other. A line for each file says what it shows, or why it cannot be drawn.
    """
    from tissue.study.figures.catalogue import draw_all

    with messages():
        for one in draw_all(folder):
            files = f"{one.files[0]} and {one.files[1].suffix}:" if one.files else one.name
            print(f"{files} {one.told}", flush=True)
