"""The page of the tissue: accuracy, speed and stability of its substeps, its growth, DAHA."""

from __future__ import annotations

from collections.abc import Sequence

from tissue.files.parameters import preset
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.runs.simulate import simulate
from tissue.study.outcomes import outcomes
from verification.page.context import Context
from verification.page.parts import Section
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
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
    return [Finding(said["height"], substeps.TITLE)]


CHAPTER = Chapter(
    "tissue",
    "Tissue",
    "How exact, fast and stable are the substeps of PBD in a growing tissue, and is the quasi-steady method better?",
    run,
    sections,
    findings,
    place=7,
    prepare=compile_kernels,
    tables=("tissue_",),
)
