"""EMT: what makes cells leave the tissue, by the studies of chapter 4, beside what the thesis says."""

from __future__ import annotations

from collections.abc import Sequence

from verification.page.report import Chapter, Context, Section
from verification.thesis.chapter4 import kept, studies
from verification.thesis.chapter4 import sections as page


def run(context: Context) -> None:
    """Complete the studies of the form, and sum them up; beside a short form stand the kept tables."""
    results = studies.watched(
        studies.chosen(context.form(studies.SHORT, studies.FULL)), page.folder(context), context.executor
    )
    for name, table in (kept.COMPLETE if context.full else kept.TABLES).items():
        context.keep(f"emt_{name}", table(results))
    complete = kept.tables()
    if context.full:
        complete = {f"{kept.COMPLETE_PREFIX}{name}": context.tables[f"emt_{name}"] for name in kept.COMPLETE}
    for name, table in complete.items():
        context.keep(name, table)


def sections(context: Context) -> Sequence[Section]:
    """From the isolated cell to the heterogeneous group, the eight questions, and what the short form says."""
    return page.sections(context)


CHAPTER = Chapter("EMT", run, sections, place=6, tables=("emt_",))
