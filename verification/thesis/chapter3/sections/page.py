"""The page of the tissue: accuracy, speed and stability of its substeps, its growth, DAHA."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from tissue.files.parameters import preset
from tissue.pictures.movie import write_images
from tissue.pictures.picture import stills
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.runs.simulate import simulate
from tissue.study.outcomes import outcomes
from verification.page.context import Context
from verification.page.parts import Section
from verification.page.prose import fill
from verification.page.report import Card, Chapter, Finding
from verification.thesis.chapter3.growing import until
from verification.thesis.chapter3.sections import catch_up, daha, growth, judged, kernel, predicted, stability, substeps
from verification.thesis.chapter3.sections.part import PROSE
from verification.thesis.chapter3.substeps import ENOUGH

# In the order of the page; a part may read the tables of those before it.
PARTS = (
    substeps.PART,
    catch_up.PART,
    predicted.PART,
    growth.PART,
    stability.PART,
    daha.PART,
    judged.PART,
    kernel.PART,
)


def compile_kernels() -> None:
    """Let numba compile and keep what takes it longest, by the shortest runs there are; those of EMT, too."""
    brief = preset("thesis").changed(until(0.1))
    simulate(brief, 0)
    simulate_quasi_steady(brief, 0, throw=False)
    outcomes(brief, [0], [0])


def run(context: Context) -> None:
    """Complete all studies of the tissue."""
    for part in PARTS:
        part.run(context)


def sections(context: Context) -> Sequence[Section]:
    """Return one section for each of ``PARTS``."""
    return [part.section(context) for part in PARTS]


def findings(context: Context) -> Sequence[Finding]:
    """Return the number of substeps from which on the height is right, in each preset."""
    table = context.tables["tissue_enough"]
    last = table[table["t"] == table["t"].max()]
    said = fill(PROSE / "learned.html", enough=ENOUGH, t=last["t"].iloc[0], rows=list(last.itertuples()))
    picture = context.draw("card_tissue", grow, ending=".webp")
    return [Finding(said["height"], substeps.TITLE, Card(picture, said["height"], 7))]


def grow(path: Path) -> Path:
    """Write a movie of a growing tissue for the first page, at half of the usual size."""
    parameters = preset("thesis").changed({"tissue.cells": 24, "numerics.keep": "2 h"})
    frames = simulate(parameters, seed=0).frames
    path.parent.mkdir(parents=True, exist_ok=True)
    images = (np.asarray(Image.fromarray(still).reduce(2)) for still in stills(frames, parameters))
    write_images(images, len(frames), path)
    return path


CHAPTER = Chapter(
    "tissue",
    "Tissue",
    "How exact, fast and stable are the substeps of PBD in a growing tissue, and is the quasi-steady method better?",
    run,
    sections,
    findings,
    place=9,
    prepare=compile_kernels,
    tables=("tissue_",),
)
