"""The corrections as a document for the author of the thesis: ``errata.html`` and ``errata.tex``, in page order."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from dincl.files import write_text
from verification.claims import Effect
from verification.page.formulas import marked, typeset
from verification.page.render import counted
from verification.thesis.register import chapter_of, register
from verification.thesis.text.errata import errata

MAKES_NO_NUMBERS = True
TITLES = ("Introduction", "Chapter 1", "Chapter 2", "Chapter 3", "Chapter 4", "Chapter 5", "Conclusions")
APPENDIX = "Appendix"
# Subscripts and superscripts as they are written in plain text: X_i, R^soft, x_{i,j}, d^max-basal.
SCRIPT = re.compile(r"([_^])(?:\{([^{}]*)\}|([^\W_]+(?:-[a-z]+)*|[*+-]))")
TEX = str.maketrans(
    {"\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
    | {sign: f"\\{sign}" for sign in "$&%#_"}
)


@dataclass(frozen=True)
class Erratum:
    """One correction: where, as printed, to be read, why, what depends on it, what it changes."""

    id: str
    part: str
    source: str
    printed: str
    corrected: str
    why: str
    depends: str
    effect: Effect
    place: int


def listed_errata() -> list[Erratum]:
    """Return all corrections of the register and all errata of notation, in the order of the text."""
    return sorted((*_corrections(), *_remarks()), key=lambda one: one.place)


def _corrections() -> Iterator[Erratum]:
    for claim in register():
        if claim.correction:
            found = claim.correction
            part = APPENDIX if ".appendix." in claim.check.__module__ else TITLES[chapter_of(claim)]
            texts = (claim.quote, found.text, found.why, found.depends)
            yield Erratum(claim.id, part, claim.source, *texts, found.effect, found.place)


def _remarks() -> Iterator[Erratum]:
    for row in errata().itertuples():
        part = APPENDIX if row.source.startswith(("(A.", "appendix")) else TITLES[row.chapter]
        texts = (row.printed, row.corrected, row.why, row.depends)
        yield Erratum(row.id, part, row.source, *texts, Effect.NOTATION, row.place)


def write_errata(folder: Path) -> list[Path]:
    """Write both forms into ``folder``; return the files. LuaLaTeX sets the second one: it has signs of all kinds."""
    found = listed_errata()
    values = {
        "parts": [(part, [one for one in found if one.part == part]) for part in (*TITLES, APPENDIX)],
        "effects": [(effect, [one for one in found if one.effect is effect]) for effect in Effect],
        "total": len(found),
    }
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, environment, finished in (("errata.html", _html(), typeset), ("errata.tex", _tex(), str)):
        path = folder / name
        write_text(path, finished(environment.get_template(name).render(values)))
        written.append(path)
    return written


def _html() -> Environment:
    made = Environment(
        loader=PackageLoader("verification.thesis", "templates"),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {"marked": marked, "counted": counted}
    return made


def _tex() -> Environment:
    """Replace signs that LaTeX does not use."""
    made = Environment(
        loader=PackageLoader("verification.thesis", "templates"),
        undefined=StrictUndefined,
        autoescape=False,
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["marked"] = as_tex
    return made


def as_tex(text: str) -> str:
    """Return a text with its subscripts and superscripts as LaTeX."""
    commands = {"_": r"\textsubscript", "^": r"\textsuperscript"}
    found, end = "", 0
    for match in SCRIPT.finditer(text):
        script = match[2] if match[2] is not None else match[3]
        found += f"{text[end : match.start()].translate(TEX)}{commands[match[1]]}{{{script.translate(TEX)}}}"
        end = match.end()
    return found + text[end:].translate(TEX)
