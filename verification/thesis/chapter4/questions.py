"""The eight questions of chapter 4 (4, 4.7): the answer of the thesis, what was measured, and whether the two agree.

An answer is taken apart into claims about the ratio of basal extrusion at the end of the runs: one kind of cells has a
larger ratio than another, or the two are alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import pandas as pd

from tissue.statistics.categories import NO_INM, by_order, by_selection, happened, kept_times, outcome, time_column
from tissue.statistics.comparisons import Difference, within
from tissue.statistics.ranking import FEWEST, by_importance
from tissue.statistics.ratios import Ratio, ratio
from verification.thesis.chapter4.ratio_claims import CLAIM_LEVEL, RatioClaim, RatioVerdict, alike, more

POPULATIONS = ("63 % [P]", "35 % [P]", "7 % [P]")
GROUP = ", 10 cells"
# Cells of a population by the order of their events: the scenario with such cells at the same range of times, alone or
# in a group of their like.
PROGRAMS = {"[A]": "[A] at any time", "[B]": "[B] at any time"}
PROGRAMS |= dict.fromkeys(("[AB]", "[BA]"), "[A] and [B] at any time")
ANY_TIME = " at any time"  # scenarios with random event times: the events before it
EARLY, LATE = 12.0, 18.0  # [h], of event times from 6 h to 24 h
MOST_BASAL = 0.2  # of the apical-basal scale (4.6)
SEED = 0  # of the ranking
FEW = 20  # cells of a kind; fewer make no claim

Tables = Mapping[str, pd.DataFrame]
Side = tuple[pd.DataFrame, pd.Series | None]  # a table, and which of its cells: None for all


class Question(NamedTuple):
    """A question, the answer of section 4.7 of chapter 4, its claims.

    ``mostly``: it says what is so for most, not for all.
    """

    text: str
    thesis: str
    claims: Callable[[Tables], Iterator[RatioClaim]]
    mostly: bool = False


@dataclass(frozen=True)
class QuestionAnswer:
    """A question of the thesis with its answer and with what the runs say.

    Attributes
    ----------
    question, thesis
        As in section 4.7 of chapter 4, shortened.
    measured
        A sentence for each claim, with intervals.
    verdict
        Of the claims together: "holds" if all hold, "does not hold" if one does not; where the thesis says "mostly",
        what more than half of them say.
    needed
        The most runs of a kind that a claim that is not decided needs; None if nothing is known or all is decided.
    """

    question: str
    thesis: str
    measured: tuple[str, ...]
    verdict: RatioVerdict
    needed: int | None


def answers(tables: Tables) -> dict[str, QuestionAnswer]:
    """Return the answers to Q1 to Q8.

    Parameters
    ----------
    tables
        Tables of EMT cells by scenario, of the studies for Figure 15 and Table 5 of chapter 4 and of the one for the
        questions.
        Claims about scenarios that are not there are left out; a question without any claim is not decided.

    Returns
    -------
    dict[str, Answer]
        By "Q1" to "Q8".
    """
    return {name: _answer(question, list(question.claims(tables))) for name, question in QUESTIONS.items()}


def _answer(question: Question, claims: list[RatioClaim]) -> QuestionAnswer:
    verdict = _together([claim.verdict for claim in claims], mostly=question.mostly)
    runs = [claim.needed for claim in claims if claim.needed is not None]
    measured = tuple(f"{claim.text}: {claim.verdict}." for claim in claims)
    needed = max(runs, default=None) if verdict == "not decided" else None
    return QuestionAnswer(question.text, question.thesis, measured, verdict, needed)


def _together(verdicts: list[RatioVerdict], *, mostly: bool) -> RatioVerdict:
    held, refuted, total = verdicts.count("holds"), verdicts.count("does not hold"), len(verdicts)
    if total and (2 * held > total if mostly else held == total):
        return "holds"
    return "does not hold" if total and (2 * refuted >= total if mostly else refuted) else "not decided"


def _end(cells: pd.DataFrame) -> float:
    return kept_times(cells)[-1]


def _hits(cells: pd.DataFrame) -> pd.Series:
    return outcome(cells, "basal", _end(cells))


def _of(cells: pd.DataFrame, kind: pd.Series | None = None) -> Ratio | None:
    """Return the ratio of the cells of a kind, all if it is None; None for too few."""
    chosen = cells if kind is None else cells[kind]
    return ratio(_hits(chosen), chosen["replicate"]) if len(chosen) >= FEW else None


def _runs(*tables: pd.DataFrame) -> int:
    return min(int(table["replicate"].nunique()) for table in tables)


def _between(claim: Callable[..., RatioClaim], text: str, *sides: Side) -> Iterator[RatioClaim]:
    """Give a claim about cells of different replicates, if there are enough."""
    first, second = (_of(*side) for side in sides)
    if first is not None and second is not None:
        yield claim(text, Difference(first, second), _runs(*(table for table, _ in sides)))


def _inside(
    claim: Callable[..., RatioClaim], text: str, cells: pd.DataFrame, first: pd.Series, second: pd.Series
) -> Iterator[RatioClaim]:
    """Give a claim about two kinds of cells of the same replicates, if there are enough."""
    if min(first.sum(), second.sum()) >= FEW:
        yield claim(text, within(_hits(cells), cells["replicate"], first, second), _runs(cells))


def _populations(tables: Tables) -> Iterator[tuple[str, pd.DataFrame]]:
    return ((name, tables[name]) for name in POPULATIONS if name in tables)


def _own_and_mixed(tables: Tables, suffix: str) -> Iterator[tuple[str, Side, Side]]:
    """Give cells alone, or in a group of their like, and cells of a population with the same events in that order."""
    for population, cells in _populations(tables):
        orders = by_order(cells, _end(cells), inm=True)
        for order, program in PROGRAMS.items():
            for inm in ("", NO_INM):
                if (own := tables.get(f"{program}{inm}{suffix}")) is not None:
                    kind = f"{order}{inm}"
                    those = by_order(own, _end(own), inm=True) == kind
                    yield f"{kind} against those of {population}", (own, those), (cells, orders == kind)


def _q1(tables: Tables) -> Iterator[RatioClaim]:
    for text, own, mixed in _own_and_mixed(tables, ""):
        yield from _between(more, f"{text}, alone more", own, mixed)


def _q2(tables: Tables) -> Iterator[RatioClaim]:
    for name, cells in _populations(tables):
        selection = by_selection(cells, _end(cells), inm=True)
        for events in ("A", "B", "BP"):
            for inm in (NO_INM,) if events != "BP" else ("", NO_INM):
                text = f"{name}: {events}{inm} more than no event{inm}"
                yield from _inside(more, text, cells, selection == f"{events}{inm}", selection == f"none{inm}")


def _timed(tables: Tables) -> Iterator[tuple[str, pd.DataFrame, str, pd.Series]]:
    """Give tables with random times of an event, and the cells to look at: [P] would hide what the others do."""
    for name, cells in _populations(tables):
        protrudes = happened(cells, _end(cells))["P"]
        for event in "AB":
            yield f"{name}, without [P]", cells, event, ~protrudes
        yield f"{name}, with [P]", cells, "P", protrudes
    for event in "AB":
        for name in (f"[{event}]{ANY_TIME}{inm}" for inm in ("", NO_INM)):
            if name in tables:
                yield name, tables[name], event, tables[name]["replicate"] >= 0


def _q3(tables: Tables) -> Iterator[RatioClaim]:
    for name, cells, event, kind in _timed(tables):
        times = cells[time_column(event)]
        early, late = kind & (times <= EARLY), kind & (times > LATE) & (times < _end(cells))
        text = f"{name}: [{event}] until {EARLY:g} h against after {LATE:g} h"
        yield from _inside(more if event == "A" else alike, text, cells, early, late)


def _q4(tables: Tables) -> Iterator[RatioClaim]:
    isolated = (f"[A] and [B]{ANY_TIME}{inm}" for inm in ("", NO_INM))
    for name in (*POPULATIONS, *isolated):
        if (cells := tables.get(name)) is None:
            continue
        orders = by_order(cells, _end(cells), inm=True)
        for inm in ("", NO_INM):
            first, second = f"[AB]{inm}", f"[BA]{inm}"
            yield from _inside(alike, f"{name}: {first} like {second}", cells, orders == first, orders == second)


def _q5(tables: Tables) -> Iterator[RatioClaim]:
    for group in (name for name in tables if name.endswith(GROUP)):
        if (name := group.removesuffix(GROUP)) in tables:
            yield from _between(
                more, f"{name}, alone more than in a group", (tables[name], None), (tables[group], None)
            )
    for text, own, mixed in _own_and_mixed(tables, GROUP):
        yield from _between(more, f"{text}, mixed more", mixed, own)
    for inm in ("", NO_INM):
        any_time, same_time = f"[A] and [B]{ANY_TIME}{inm}{GROUP}", f"[AB]{inm}{GROUP}"
        if any_time in tables and same_time in tables:
            yield from _between(
                more, f"{any_time} more than {same_time}", (tables[any_time], None), (tables[same_time], None)
            )


def _q6(tables: Tables) -> Iterator[RatioClaim]:
    for without in (name for name in tables if "B" in name and "P" not in name and NO_INM in name):
        if (name := without.replace(NO_INM, "")) in tables:
            yield from _between(more, f"{without} more than {name}", (tables[without], None), (tables[name], None))


def _q7(tables: Tables) -> Iterator[RatioClaim]:
    for name, table in _populations(tables):
        cells = table[~happened(table, _end(table))["P"] & table["onset_ab"].notna()]
        low = (cells["onset_ab"] <= MOST_BASAL).astype(bool)
        yield from _inside(more, f"{name}: without [P], the most basal fifth more", cells, low, ~low)
        yield from _onset_first(name, cells)


def _onset_first(name: str, cells: pd.DataFrame) -> Iterator[RatioClaim]:
    """Give the claim that the position at the onset tells more than any event and any event time."""
    hits = _hits(cells)
    if min(hits.sum(), (~hits).sum()) < FEWEST:
        return
    table = by_importance(cells, hits, _end(cells), seed=SEED, level=CLAIM_LEVEL).table.set_index("factor")
    others = table.drop(index=["inm", "onset", "place", "others with [P]"], errors="ignore").sort_values("value")
    if "onset" not in table.index or others.empty:
        return
    onset, best = table.loc["onset"], others.iloc[-1]
    verdict: RatioVerdict = "holds" if onset["low"] > others["high"].max() else "not decided"
    verdict = "does not hold" if onset["high"] < others["low"].max() else verdict
    text = f"{name}: importance of the onset {onset['value']:.3f} nats, of {best.name} {best['value']:.3f} nats"
    yield RatioClaim(text, verdict)


def _q8(tables: Tables) -> Iterator[RatioClaim]:
    if POPULATIONS[0] not in tables or POPULATIONS[-1] not in tables:
        return
    strong, weak = tables[POPULATIONS[0]], tables[POPULATIONS[-1]]
    kinds = [by_selection(cells, _end(cells), inm=True) for cells in (weak, strong)]
    for events in ("A", "B", "AB"):
        sides = ((weak, kinds[0] == events), (strong, kinds[1] == events))
        yield from _between(more, f"{events} more in {POPULATIONS[-1]} than in {POPULATIONS[0]}", *sides)


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
    ),
    "Q4": Question(
        "Do specific orders of EMT events lead to more basal extrusion?",
        "The order can lead to small differences, which are better explained by the absolute timing of one event.",
        _q4,
    ),
    "Q5": Question(
        "Is it an advantage if all cells of a group have the same timings, or is a mixture better?",
        "Individual cells are more effective than groups; for most programs mixed groups beat homogeneous ones.",
        _q5,
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
