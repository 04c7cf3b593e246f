"""The search for the simplest model, on models whose biases add up."""

from collections.abc import Sequence

from tissue.statistics.equivalence import Equivalence
from tissue.study.elimination import AND, Row, compared, search

# Bias and CPU time of each simplification; the tolerance is 1.
BIASES = {"a": 0.3, "b": -0.6, "c": 0.9, "d": 2.0, "e": 0.1}
COSTS = {"a": 0.5, "b": 0.9, "c": 0.8, "d": 0.1, "e": 0.7}
KINDS = {"a": "first", "b": "second", "c": "third", "d": "third", "e": "first"}


class Added:
    """Models whose biases add up, and that note what they were asked."""

    def __init__(self) -> None:
        self.asked: list[tuple[tuple[str, ...], float, bool]] = []

    def decide(self, models: Sequence[str], error: float, *, again: bool) -> list[Row]:
        self.asked.append((tuple(models), error, again))
        return [self.row(model) for model in models]

    def row(self, model: str) -> Row:
        names = model.split(AND)
        bias = sum(abs(BIASES[name]) for name in names)
        cost = min(COSTS[name] for name in names)
        return compared(
            model, Equivalence(bias, bias - 0.01, bias + 0.01, 1.0, 0.1, 64, 0.01), cpu=cost, work=cost, runs=64
        )


def test_the_largest_bias_is_dropped_until_the_combination_is_enough() -> None:
    decider = Added()
    found = search(decider, KINDS, dict.fromkeys(KINDS, ""))
    # Of the kind "first" a is cheaper than e. 0.3 + 0.6 + 0.9 > 1, without c 0.9 < 1.
    together = found.table[found.table["step"] == "together"]
    assert together["model"].tolist() == ["a + b + c", "a + b"]
    assert together["verdict"].tolist() == ["not enough", "enough"]
    assert found.answer == ("a", "b")
    assert found.saving == (2.0, 2.0)
    assert [error for _, error, _ in decider.asked] == [0.05, 0.025, 0.0125]
    assert [again for *_, again in decider.asked] == [False, True, True]


def test_what_is_left_out_is_not_tried_and_says_why() -> None:
    decider = Added()
    found = search(decider, KINDS, dict.fromkeys(KINDS, "") | {"a": "there is no a"})
    assert decider.asked[0][0] == ("b", "c", "d", "e")
    assert found.table.set_index("model").loc["a", ["verdict", "reason"]].tolist() == ["left out", "there is no a"]
    assert found.answer == ("b", "e")


def test_without_a_simplification_that_is_enough_the_full_model_is_needed() -> None:
    found = search(Added(), {"d": "third"}, {"d": ""})
    assert found.answer == ()
    assert found.saving == (1.0, 1.0)


def test_counted_work_decides_between_equal_cpu_times() -> None:
    costs = {"a": (0.50, 0.5), "e": (0.51, 0.4)}

    class Equal(Added):
        def row(self, model: str) -> Row:
            cpu, work = costs[model]
            return super().row(model) | {"cpu": cpu, "work": work}

    # By CPU time a is cheaper than e, but by 2 % only; e takes less counted work.
    assert search(Equal(), {"a": "first", "e": "first"}, {"a": "", "e": ""}).answer == ("e",)
