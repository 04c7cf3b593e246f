"""The answers to the eight questions of chapter 4 follow from tables where they are known."""

import numpy as np
import pytest

from tests.tissue.study.test_ranking import emt_cells
from tissue.statistics import ranking
from tissue.statistics.categories import NO_INM
from verification.thesis.chapter4.questions import GROUP, POPULATIONS, QUESTIONS, answers

MIXTURES = ("[A]", "[B]", "[A] and [B]")


def log_odds(table, sign, crowd):
    """Passive cells leave by INM, onset and a time of [A], as the thesis says, or all the other way round."""
    protrudes = np.isfinite(table["t_p_h"])
    some = np.isfinite(table["onset_h"])
    onset = table["onset_ab"].fillna(0.5).astype(float)
    early = 15 - table["t_a_h"].where(np.isfinite(table["t_a_h"]), 15)
    passive = 2 * some + sign * (0.1 * early + (1.5 * ~table["inm"] + 6 * (0.5 - onset)) * some - crowd)
    return -3 + np.where(protrudes, 5, passive)


def tables(sign, runs=300):
    """The three populations, and four programs alone and in a group; the larger ``crowd``, the more are in the way."""
    made = {}
    for seed, (name, p, crowd) in enumerate(zip(POPULATIONS, (0.9, 0.5, 0.1), (1, 0.5, 0), strict=True)):
        made[name] = emt_cells(runs, 10, seed, lambda table, crowd=crowd: log_odds(table, sign, crowd), p=p)
    for name, times in {"[Bx]": {"b": 6.0}, "[AxB]": {"a": 6.0, "b": 18.0}}.items():
        for suffix, count, crowd in (("", 1, -2), (GROUP, 10, 2)):
            for inm, has in (("", True), (" no INM", False)):
                made[f"{name}{inm}{suffix}"] = emt_cells(
                    runs,
                    count,
                    9,
                    lambda table, crowd=crowd, has=has: log_odds(table.assign(inm=has), sign, crowd),
                    fixed=times,
                )
    for suffix, count, crowd in (("", 1, -2), (GROUP, 10, 2)):
        own = emt_cells(runs, count, 9, lambda table, crowd=crowd: log_odds(table, sign, crowd), p=0)
        for name in ("[A] at any time", "[B] at any time"):
            made |= {f"{name}{inm}{suffix}": own[own["inm"] == (not inm)] for inm in ("", NO_INM)}
    return made


@pytest.fixture(scope="module")
def found():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ranking, "SHUFFLES", 1)
        patch.setattr(ranking, "FOLDS", 2)
        return {sign: answers(tables(sign)) for sign in (1, -1)}


def test_answers_where_the_thesis_is_right(found):
    assert list(found[1]) == [f"Q{k}" for k in range(1, 9)]
    verdicts = {name: answer.verdict for name, answer in found[1].items()}
    assert {name for name, verdict in verdicts.items() if verdict == "holds"} >= {"Q1", "Q2", "Q5", "Q6", "Q7"}
    assert "does not hold" not in verdicts.values()


def test_the_first_question_is_asked_of_each_order_of_events():
    """[A], [B] and both orders of both, with INM and without, each alone against its like in the population."""
    alone = emt_cells(600, 1, 4, lambda table: log_odds(table, 1, -2), p=0)
    mixed = {f"{name} at any time{inm}": alone[alone["inm"] == (not inm)] for inm in ("", NO_INM) for name in MIXTURES}
    mixed[POPULATIONS[2]] = emt_cells(300, 10, 2, lambda table: log_odds(table, 1, 0), p=0.1)
    asked = {claim.text.partition(" against those of ")[0] for claim in QUESTIONS["Q1"].claims(mixed)}
    assert asked == {f"{order}{inm}" for order in ("[A]", "[B]", "[AB]", "[BA]") for inm in ("", NO_INM)}


def test_answers_where_the_thesis_is_wrong(found):
    """What helps and what hinders is exchanged: only the claims about size, not about direction, are left."""
    verdicts = {name: answer.verdict for name, answer in found[-1].items()}
    assert {name for name, verdict in verdicts.items() if verdict == "does not hold"} >= {"Q1", "Q3", "Q5", "Q6", "Q7"}


@pytest.mark.parametrize(
    ("onset", "time", "verdict"),
    [(6, 0, "holds"), (0, 0.3, "does not hold"), (4, 0.17, "not decided"), (3, 0.17, "not decided")],
)
def test_rank_of_the_onset(onset, time, verdict, monkeypatch):
    """The claim of Q7 follows what the outcome was made from: the onset, the time of [A], or both."""
    monkeypatch.setattr(ranking, "SHUFFLES", 1)

    def odds(table):
        late = table["t_a_h"].where(np.isfinite(table["t_a_h"]), 15.0) - 15.0
        return onset * (0.5 - table["onset_ab"].fillna(0.5).astype(float)) - time * late

    answer = answers({POPULATIONS[1]: emt_cells(150, 10, 3, odds)})["Q7"]
    assert "importance of the onset" in answer.measured[-1]
    assert answer.measured[-1].endswith(f": {verdict}.")


def test_events_at_any_time():
    """Q3 and Q4 on isolated cells, Q5 on groups: an early [A] helps, so an order with early [A] does."""
    alone = {name: emt_cells(4000, 1, 4, lambda table: log_odds(table, 1, 0), p=0) for name in ("[A]", "[B]")}
    made = {f"{name} at any time": table[np.isfinite(table[f"t_{name[1].lower()}_h"])] for name, table in alone.items()}
    made["[A] and [B] at any time"] = alone["[A]"]
    verdicts = {name: [line.rpartition(": ")[2] for line in found.measured] for name, found in answers(made).items()}
    assert verdicts["Q3"] == ["holds.", "holds."]
    assert verdicts["Q4"] == ["not decided.", "not decided."]
    groups = {
        "[A] and [B] at any time no INM, 10 cells": emt_cells(100, 10, 4, lambda table: 0.5 + 0 * table["cell"]),
        "[AB] no INM, 10 cells": emt_cells(100, 10, 4, lambda table: -0.5 + 0 * table["cell"]),
    }
    groups["[A] and [B] at any time, 10 cells"] = groups["[AB] no INM, 10 cells"]
    found = answers(groups)
    assert (found["Q5"].verdict, len(found["Q5"].measured)) == ("holds", 1)
    assert (found["Q6"].verdict, len(found["Q6"].measured)) == ("holds", 1)


def test_answers_that_need_more_runs(found):
    for answer in [*found[1].values(), *found[-1].values()]:
        assert answer.needed is None or answer.verdict == "not decided"
        assert all(line.endswith((": holds.", ": does not hold.", ": not decided.")) for line in answer.measured)
    few = answers({name: table for name, table in tables(1, runs=25).items() if "[Bx]" in name})
    assert few["Q2"].measured == ()
    assert few["Q6"].verdict in ("holds", "not decided")


def test_answers_of_nothing():
    for answer in answers({}).values():
        assert (answer.verdict, answer.measured, answer.needed) == ("not decided", (), None)
