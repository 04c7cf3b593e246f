"""The answers to the eight questions of chapter 4 follow from tables where they are known."""

import pytest

from tests.verification.thesis.tables import shipped_tables
from verification.claims import Comparison, Verdict
from verification.thesis.chapter4.frequencies import GROUPS, RATIOS, READINGS, Sized
from verification.thesis.chapter4.questions import QUESTIONS, QuestionAnswer, answer, answered

KEPT = shipped_tables()


def parts(held: int, refuted: int, undecided: int) -> tuple[Sized, ...]:
    """So many comparisons that hold, that do not, and that are open."""
    ends = [(1.0, 2.0)] * held + [(-2.0, -1.0)] * refuted + [(-1.0, 1.0)] * undecided
    return tuple(Sized(Comparison("x", sum(end) / 2, 0.0, float("inf"), end), 100 + k) for k, end in enumerate(ends))


@pytest.mark.parametrize(
    ("counts", "mostly", "verdict"),
    [
        ((4, 0, 0), False, Verdict.HOLDS),
        ((4, 1, 0), False, Verdict.REFUTED),
        ((4, 0, 1), False, Verdict.OPEN),
        ((3, 1, 1), True, Verdict.HOLDS),
        ((2, 2, 0), True, Verdict.REFUTED),
        ((2, 1, 1), True, Verdict.OPEN),
        ((0, 0, 0), False, Verdict.HOLDS),
    ],
)
def test_an_answer_holds_if_all_or_most_of_its_comparisons_do(
    counts: tuple[int, int, int], mostly: bool, verdict: Verdict
) -> None:
    found = QuestionAnswer(parts(*counts), mostly).evidence
    assert found.verdict is verdict
    assert found.runs_needed == (99 + sum(counts) if verdict is Verdict.OPEN else None)


@pytest.mark.parametrize("question", QUESTIONS)
def test_each_question_is_asked_in_every_reading(question: str) -> None:
    for preset in READINGS:
        assert answer(KEPT, question, preset).parts


def test_kinds_of_which_no_cell_leaves_or_all_do_tell_nothing() -> None:
    names = [part.comparison.what for part in answer(KEPT, "Q5", "published").parts]
    assert not any(name.startswith("no EMT") for name in names)
    for count in (0, KEPT[RATIOS]["of"]):
        assert answer(KEPT | {RATIOS: KEPT[RATIOS].assign(count=count)}, "Q5", "published").parts == ()


def test_the_last_question_is_asked_of_cells_with_inm_and_without() -> None:
    """The mean of six kinds changes with either."""
    (mean,) = answer(KEPT, "Q8", "published").parts
    for kind in ("[A]", "[A] no INM", "[BA]", "[B] no INM"):
        table = KEPT[GROUPS]
        mine = (table["kind"] == kind) & (table["study"] == "table5_7_published")
        changed = {**KEPT, GROUPS: table.assign(count=table["count"].where(~mine, 0))}
        (less,) = answer(changed, "Q8", "published").parts
        assert less.comparison.value < mean.comparison.value


def test_orders_are_compared_at_the_same_time_of_a() -> None:
    """What the order explains is less than what it seems to explain at any time; small with corrected energies."""
    for preset in READINGS:
        found = {part.comparison.what: part.comparison for part in answer(KEPT, "Q4", preset).parts}
        for inm in ("INM", "no INM"):
            same = found[f"{inm}, [AB] minus [BA] with [A] at the same time [points]"]
            more = found[f"{inm}, [AB] minus [BA] with [A] at any time, minus with [A] at the same time [points]"]
            assert same.true or preset == "thesis"
            assert more.value > abs(same.value)


@pytest.mark.slow
def test_the_table_has_a_row_for_each_comparison() -> None:
    table = answered(KEPT)
    assert len(table) == sum(len(answer(KEPT, name, preset).parts) for name in QUESTIONS for preset in READINGS)
    assert (table.groupby(["preset", "id"])["verdict"].nunique() == 1).all()
    assert table["found"].str.endswith((": holds", ": refuted", ": open")).all()
