"""The eight questions of chapter 4 (4, 4.7): the answer of the thesis, what the runs say, and whether the two agree.

An answer is taken apart into comparisons of ratios of basal extrusion at the end of the runs, by the kept tables: one
kind of cells has a larger ratio than another, or the two are alike. Two kinds of which all cells leave, or none, tell
nothing, and are left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import pandas as pd

from tissue.study.estimates import LEVEL
from verification.claims import Comparison, Evidence, Tables, Verdict
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS
from verification.thesis.chapter4.frequencies import (
    CLAIM_LEVEL,
    KINDS,
    RANKING,
    RATIOS,
    READINGS,
    Sized,
    alike,
    apart,
    averaged,
    basal,
    between,
    category,
    cells_of,
    counted,
    groups,
    minus,
    mixed,
    more,
    most_runs,
    own,
    pooled,
    runs_by_width,
)
from verification.thesis.chapter4.groups import ORDERS, RANKED
from verification.thesis.chapter4.ratios import NO_INM, ProportionContrast, Ratio, as_ratio, quantile

ANSWERS = "emt_answers"
MIXTURES = ("[A]", "[B]", "[A] and [B]")
INM = ("", NO_INM)
GROUP = ", 10 cells"
FIRST, EARLY, LATE, LAST = 6.0, 12.0, 18.0, 24.0  # [h], of event times
FIFTH = 0.2  # of the apical-basal scale (4.6)


class Question(NamedTuple):
    """A question, the answer of section 4.7 of chapter 4, its comparisons in one reading of the model.

    ``mostly``: the answer says what is so for most, not for all.
    """

    text: str
    thesis: str
    compare: Callable[[Tables, str], Iterator[Sized]]
    mostly: bool = False


@dataclass(frozen=True)
class QuestionAnswer:
    """Comparisons of an answer in one reading of the model.

    Attributes
    ----------
    parts
        The comparisons.
    mostly
        Whether more than half of them have to hold, in place of all.
    """

    parts: tuple[Sized, ...]
    mostly: bool

    @property
    def evidence(self) -> Evidence:
        """The comparisons; if most of them have to hold, how many do."""
        found = tuple(part.comparison for part in self.parts)
        if self.mostly:
            found = (counted("comparisons that hold", found, len(found) // 2 + 1),)
        made = Evidence(printed=found)
        runs = most_runs(part.runs for part in self.parts if part.comparison.true is None)
        return replace(made, runs_needed=runs) if made.verdict is Verdict.OPEN else made


def answer(tables: Tables, question: str, preset: str) -> QuestionAnswer:
    """Return the answer to a question of ``QUESTIONS`` in one reading."""
    asked = QUESTIONS[question]
    return QuestionAnswer(tuple(asked.compare(tables, preset)), asked.mostly)


def answered(tables: Tables) -> pd.DataFrame:
    """Return one row for each comparison of each question and reading, with the verdict on the whole answer."""
    rows = []
    for preset in READINGS:
        for name, question in QUESTIONS.items():
            found = answer(tables, name, preset)
            whole: dict[str, object] = {
                "preset": preset,
                "id": name,
                "question": question.text,
                "thesis": question.thesis,
            }
            whole |= {"verdict": found.evidence.verdict.value, "needed": found.evidence.runs_needed}
            rows += [whole | _row(part.comparison) for part in found.parts]
    return pd.DataFrame(rows)


def _row(comparison: Comparison) -> dict[str, str]:
    verdict = {True: "holds", False: "refuted", None: "open"}[comparison.true]
    found = str(comparison).removeprefix(f"{comparison.what}: ")
    return {"compared": comparison.what, "found": f"{found}: {verdict}"}


def _unlike(text: str, first: Ratio, second: Ratio) -> Iterator[Sized]:
    """Give the comparison "first more than second", unless no cell of both kinds leaves, or all do."""
    if 0 < first.count + second.count < first.of + second.of:
        yield more(text, minus((first, second)))


def program(tables: Tables, preset: str, name: str) -> Ratio:
    """Return basal extrusion by a program of Table 4 or of the questions, of the study with the most runs of it."""
    return basal(tables, preset, ("inm", "figure15", "questions"), name)


def programs(tables: Tables, preset: str) -> list[str]:
    """Return the programs of Table 4 and of the questions, without INM and without the ends of their names."""
    table = tables[RATIOS]
    studies = [name + PRESETS[preset] for name in ("questions", "figure15")]
    names = table.loc[table["study"].isin(studies), "scenario"]
    return [name for name in dict.fromkeys(names) if not name.endswith(GROUP)]


def _q1(tables: Tables, preset: str) -> Iterator[Sized]:
    for study, population in POPULATIONS.items():
        for events, inm in ((events, inm) for events in MIXTURES for inm in INM):
            sides = (own(tables, preset, events, inm, ""), mixed(tables, preset, study, events, inm))
            yield from _unlike(f"{events}{inm}, alone minus those of {population}", *sides)


def _q2(tables: Tables, preset: str) -> Iterator[Sized]:
    for study, population in POPULATIONS.items():
        for events in (f"[A]{NO_INM}", f"[B]{NO_INM}", "[BP]", f"[BP]{NO_INM}"):
            none = "none" + (NO_INM if NO_INM in events else "")
            sides = (category(tables, preset, study, each) for each in (events, none))
            yield from _unlike(f"{population}, {events} minus {none}", *sides)


def _q3(tables: Tables, preset: str) -> Iterator[Sized]:
    """[A] and [B] of cells without [P], which would hide what they do."""
    for study, population in POPULATIONS.items():
        for event in "ABP":
            early, late = (
                pooled([between(tables, preset, study, f"t_{event.lower()}_h", inm, *ends) for inm in KINDS])
                for ends in ((FIRST, EARLY), (LATE, LAST))
            )
            text = f"{population}, [{event}] until {EARLY:g} h minus after {LATE:g} h"
            yield (more if event == "A" else alike)(text, minus((early, late)))


def _q4(tables: Tables, preset: str) -> Iterator[Sized]:
    """[A] comes earlier in [AB] than in [BA]: the orders are compared among cells with [A] in the same three hours."""
    orders = [groups(tables, preset, order) for order in ORDERS]
    for inm in KINDS:
        first, second = (rows[rows["kind"] == inm].set_index(["study", "low_edge"]) for rows in orders)
        both = first.index.intersection(second.index)
        found = averaged([minus(as_ratio(side.loc[key]) for side in (first, second)) for key in both])
        yield alike(f"{inm}, [AB] minus [BA] with [A] at the same time", found)
        whole = averaged([_all(first, second, study + PRESETS[preset]) for study in POPULATIONS])
        what = f"{inm}, [AB] minus [BA] with [A] at any time, minus with [A] at the same time"
        yield apart(what, whole.interval(CLAIM_LEVEL), found.interval(CLAIM_LEVEL), cells_of(found))


def _all(first: pd.DataFrame, second: pd.DataFrame, study: str) -> ProportionContrast:
    """Return the difference of all times together."""
    return minus(pooled([as_ratio(row) for _, row in side.loc[study].iterrows()]) for side in (first, second))


def _q5(tables: Tables, preset: str) -> Iterator[Sized]:
    for name in programs(tables, preset):
        sides = (program(tables, preset, f"{name}{group}") for group in ("", GROUP))
        yield from _unlike(f"{name}, alone minus in a group of its like", *sides)


def _q5_mixed(tables: Tables, preset: str) -> Iterator[Sized]:
    for study, population in POPULATIONS.items():
        for events, inm in ((events, inm) for events in MIXTURES for inm in INM):
            sides = (mixed(tables, preset, study, events, inm), own(tables, preset, events, inm, GROUP))
            yield from _unlike(f"{events}{inm} in {population}, mixed minus homogeneous", *sides)


def _q6(tables: Tables, preset: str) -> Iterator[Sized]:
    for name in programs(tables, preset):
        if "B" in name and "P" not in name and NO_INM not in name:
            for group in ("", GROUP):
                sides = (program(tables, preset, f"{name}{inm}{group}") for inm in (NO_INM, ""))
                yield from _unlike(f"{name}{group}, without minus with INM", *sides)


def _q7(tables: Tables, preset: str) -> Iterator[Sized]:
    for study, population in POPULATIONS.items():
        low, high = (
            pooled([between(tables, preset, study, "onset_ab", inm, *ends) for inm in KINDS])
            for ends in ((0.0, FIFTH), (FIFTH, 1.0))
        )
        yield more(f"{population}, without [P], most basal fifth minus the others", minus((low, high)))
    yield onset_first(tables, preset)


def onset_first(tables: Tables, preset: str) -> Sized:
    """Compare: beside [P] no factor tells more than the position at the onset, among all cells of '35 % [P]'.

    The intervals of the table are of 95 %, and widened to the level of claims.
    """
    table = tables[RANKING]
    mine = table[(table["study"] == RANKED + PRESETS[preset]) & (table["factor"] != "P")].set_index("factor")
    wide = quantile(CLAIM_LEVEL) / quantile(LEVEL)
    low, high = (mine["value"] + wide * (mine[side] - mine["value"]) for side in ("low", "high"))
    others = mine.index != "onset"
    lead = (low["onset"] - high[others].max(), high["onset"] - low[others].max())
    value = mine.loc["onset", "value"] - mine.loc[others, "value"].max()
    text = f"importance of the onset minus that of the next factor, {mine.loc[others, 'value'].idxmax()} [nats]"
    runs = runs_by_width(mine.loc["onset", "cells"], value, lead)
    return Sized(Comparison(text, value, 0.0, math.inf, lead), runs)


def _q8(tables: Tables, preset: str) -> Iterator[Sized]:
    """All programs without [P] together: the answer is not about each of them."""
    few, many = "table5_7", "table5_63"
    found = [
        minus(mixed(tables, preset, study, events, inm) for study in (few, many)) for events in MIXTURES for inm in INM
    ]
    text = f"mean of the six kinds without [P], in {POPULATIONS[few]} minus in {POPULATIONS[many]}"
    yield more(text, averaged(found, [1.0] * len(found)))


QUESTIONS = {
    "Q1": Question(
        "Are groups of EMT cells more efficient than isolated ones?",
        "No, in most cases heterogeneous groups are less efficient than individual cells.",
        _q1,
        mostly=True,
    ),
    "Q2": Question(
        "Is basal extrusion possible without all EMT events, and which have to occur?",
        "Yes: without INM all cells with [A], [B] or [P] are extruded; with INM only those with [P], or well placed.",
        _q2,
    ),
    "Q3": Question(
        "Are early EMT events more efficient?",
        "Mostly no. Only early [A] shows some increase.",
        _q3,
        mostly=True,
    ),
    "Q4": Question(
        "Do specific orders of EMT events lead to more basal extrusion?",
        "The order can lead to small differences, which are better explained by the absolute timing of one event.",
        _q4,
    ),
    "Q5": Question(
        "Is it an advantage to be in a group of EMT cells with the same timings?",
        "Individual cells are more effective than groups.",
        _q5,
        mostly=True,
    ),
    "Q5, mixtures": Question(
        "Is a mixture of timings better than the same timings?",
        "For most programs mixed groups beat homogeneous ones.",
        _q5_mixed,
        mostly=True,
    ),
    "Q6": Question(
        "Are EMT cells without INM more effective?",
        "Yes: lack of INM increases basal extrusion for EMT programs involving [B].",
        _q6,
    ),
    "Q7": Question(
        "Does the position of an EMT cell at the start of EMT impact the outcome?",
        "Very much so; for cells without [P] it is more important than the timing and selection of events.",
        _q7,
    ),
    "Q8": Question(
        "Do cells with very effective EMT programs decrease the efficiency of non-effective programs?",
        "Yes, a bit.",
        _q8,
    ),
}
