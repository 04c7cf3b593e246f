"""The report: what was found on the first page, then a page for each chapter, with tables and figures beside them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, replace
from pathlib import Path

from verification.site.context import Context
from verification.site.facts import machine
from verification.site.made_again import made_again
from verification.site.parts import Chart, Section
from verification.site.render import render_page


@dataclass(frozen=True)
class Card:
    """A finding on the first page: a small picture, one sentence of HTML, and its place among the cards."""

    picture: Path
    html: str
    place: int


@dataclass(frozen=True)
class Finding:
    """One or two sentences of HTML with their numbers, the title of their section, and the card, if there is one."""

    html: str
    section: str
    card: Card | None = None


@dataclass(frozen=True)
class Chapter:
    """``run`` completes the studies and fills ``context.tables``; ``sections`` writes about them, and only reads.

    ``name`` is that of the file. ``asked`` is a sentence, which ``findings`` answer. ``tables`` says how the names of
    its tables begin, so that one can be had without the other chapters.
    ``prepare`` is done by one worker while the others begin with the chapters before: two that come to the same kernels
    at the same time would both compile them.
    """

    name: str
    title: str
    asked: str
    run: Callable[[Context], None]
    sections: Callable[[Context], Sequence[Section]]
    findings: Callable[[Context], Sequence[Finding]]
    prepare: Callable[[], None] | None = None
    tables: tuple[str, ...] = ()

    @property
    def file(self) -> str:
        """The name of its page."""
        return f"{self.name}.html"


def write_report(chapters: Sequence[Chapter], context: Context) -> Path:
    """Write ``index.html`` and a page for each chapter as soon as it is ready; the path of the first.

    The pages are written from the complete studies that ship; then parts of these are made again, chapter by chapter,
    and the pages say whether they agree.
    """
    for chapter in chapters:
        if chapter.prepare is not None:
            context.executor.submit(chapter.prepare)
    pages = _Pages(chapters, context)
    pages.write_index([])
    waiting = {}
    for chapter in chapters:
        chapter.run(context)
        # At once, so that the figures of a chapter are drawn while the next one runs.
        pages.take(chapter)
        waiting[chapter], context.waiting = context.waiting, []
    for chapter, parts in waiting.items():
        for repeat in parts:
            repeat()
        if parts:
            pages.add(chapter)
    return pages.finish()


@dataclass(frozen=True)
class _Written:
    """A chapter whose studies are complete."""

    chapter: Chapter
    sections: Sequence[Section]
    findings: Sequence[Finding]
    drawings: Sequence[Future[Path]]

    @property
    def linked(self) -> list[tuple[Finding, str]]:
        """Each finding with the address of its section."""
        titles = [section.title for section in self.sections]
        return [(one, f"{self.chapter.file}#section-{titles.index(one.section) + 1}") for one in self.findings]


class _Pages:
    """The pages of a report that is being made."""

    def __init__(self, chapters: Sequence[Chapter], context: Context) -> None:
        self._chapters, self._context = chapters, context
        self._taken: dict[str, _Written] = {}
        self._ready: dict[str, _Written] = {}
        self._waiting: list[_Written] = []

    def take(self, chapter: Chapter) -> None:
        """Add a chapter that was run, and write the pages whose figures are drawn."""
        sections, findings = list(chapter.sections(self._context)), list(chapter.findings(self._context))
        drawings, self._context.drawings = self._context.drawings, []
        self._taken[chapter.name] = _Written(chapter, sections, findings, drawings)
        self._waiting.append(self._taken[chapter.name])
        self._write_ready()

    def add(self, chapter: Chapter) -> None:
        """Add to a chapter what was rerun of it."""
        again = made_again(chapter.name, self._context, self._context.agreements_of(chapter.tables))
        written = self._taken[chapter.name]
        self._waiting = [one for one in self._waiting if one.chapter is not chapter]
        self._waiting.append(replace(written, sections=[*written.sections, *again]))
        self._write_ready()

    def _write_ready(self) -> None:
        while self._waiting and all(drawing.done() for drawing in self._waiting[0].drawings):
            self._write(self._waiting.pop(0))
        self.write_index([])

    def finish(self) -> Path:
        """Write what is left, when its figures are drawn; raises what went wrong with one."""
        while self._waiting:
            self._write(self._waiting.pop(0))
        return self.write_index(list(_facts(self._chapters, self._context)))

    def write_index(self, facts: Sequence[tuple[str, str]]) -> Path:
        """Write the first page, as far as it is known; it reloads itself until ``facts`` complete it."""
        ready = [self._ready[chapter.name] for chapter in self._chapters if chapter.name in self._ready]
        findings = [(written.chapter.title, *found) for written in ready for found in written.linked]
        findings.sort(key=lambda one: one[1].card.place if one[1].card else len(findings))
        known = {"ready": set(self._ready), "agreements": list(self._context.agreements.values()), "facts": facts}
        values = {"chapters": self._chapters, "findings": findings, "here": ""}
        return render_page("index.html", self._context.out / "index.html", **values, **known)

    def _write(self, written: _Written) -> None:
        for drawing in written.drawings:
            drawing.result()
        values = {"chapters": self._chapters, "here": written.chapter.name, "written": written}
        scripts = {part.script for section in written.sections for part in section.parts if isinstance(part, Chart)}
        values["library"] = "\n".join(scripts)
        render_page("chapter.html", self._context.out / written.chapter.file, **values)
        self._ready[written.chapter.name] = written


def _facts(chapters: Sequence[Chapter], context: Context) -> Iterator[tuple[str, str]]:
    """Yield what a number depends on besides the code."""
    made = "made here" if context.full else "those that ship; a part of each was made again here"
    yield "Complete studies", f"{made} (make report FULL=1 makes them anew)"
    yield from machine()
    yield "Times", "seconds of CPU time with two runs at once, after a warm-up; building of solvers included"
