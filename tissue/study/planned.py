"""Plan of a study file: factors, whose levels are crossed into scenarios, and the comparisons of ``[compare]``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import reduce
from itertools import combinations, groupby, product
from typing import Any, Literal, get_args

from dincl.checks import describe
from tissue.files.messages import unknown
from tissue.files.parameter_files import flat, merged
from tissue.plugins import Observable, registered
from tissue.statistics.categories import What
from tissue.statistics.contrasts import Contrast, Correction, Family

Measure = Literal["difference", "ratio"]
Weights = dict[str, float]
Factors = Mapping[str, Mapping[str, Mapping[str, Any]]]  # factor -> level -> parameters
KEYS = ("outcomes", "measures", "correction", "effect", "by", "contrasts")
# Numbers of a run that may be compared, besides registered observables: means over runs at the end.
SHARES = {"controls_apical": "apical", "controls_basal": "basal"}


@dataclass(frozen=True)
class PlannedComparisons:
    """The comparisons that a study was made for; they are corrected together, for nothing else.

    Attributes
    ----------
    outcomes
        "basal", "apical", "below": proportions of EMT cells at the end; or numbers of a run, such as "height_um".
    measures
        Of proportions: "difference" in points, "ratio"; numbers are compared by differences of their means.
    correction
        Of intervals and p-values, as ``tissue.statistics.contrasts.Family`` has it.
    contrasts
        The weight of each scenario, by question.
    """

    outcomes: tuple[str, ...]
    measures: tuple[Measure, ...]
    correction: Correction
    contrasts: Mapping[str, Weights]

    @property
    def scenarios(self) -> list[str]:
        """All scenarios that have a weight."""
        return list(dict.fromkeys(name for weights in self.contrasts.values() for name in weights))

    @property
    def blocks(self) -> list[tuple[str, Measure]]:
        """Each outcome with each of its measures."""
        proportions = get_args(What)
        measures: dict[str, tuple[Measure, ...]] = {
            one: self.measures if one in proportions else ("difference",) for one in self.outcomes
        }
        return [(outcome, measure) for outcome, each in measures.items() for measure in each]

    @property
    def count(self) -> int:
        """The number of comparisons."""
        return len(self.blocks) * len(self.contrasts)

    def family(self, contrasts: Sequence[tuple[Contrast, ...]]) -> Family:
        """Return the family of the contrasts of each of ``blocks``; those of one outcome are correlated."""
        of_outcome = groupby(zip(self.blocks, contrasts, strict=True), key=lambda pair: pair[0][0])
        joined = (tuple(one for _, each in pairs for one in each) for _, pairs in of_outcome)
        return Family(tuple(joined), self.correction)

    def as_dict(self) -> dict[str, Any]:
        """Return the plan as tables of JSON."""
        return asdict(self)

    @classmethod
    def of(cls, noted: Mapping[str, Any]) -> PlannedComparisons:
        """Return the plan of ``as_dict``."""
        return cls(
            tuple(noted["outcomes"]), tuple(noted["measures"]), noted["correction"], dict(noted["contrasts"].items())
        )


def crossed(factors: Factors) -> dict[str, dict[str, Any]]:
    """Return a scenario for each combination of levels: its parameters, by its name, such as "early, arc"."""
    return {name: reduce(merged, tables, {}) for name, tables in combined(factors).items()}


def combined(factors: Factors) -> dict[str, list[Mapping[str, Any]]]:
    """Return the levels of each combination, by the name of its scenario."""
    found = (zip(names, factors.values(), strict=True) for names in product(*factors.values()))
    each = ([(name, levels[name]) for name, levels in pairs] for pairs in found) if factors else ()
    return {", ".join(name for name, _ in pairs): [table for _, table in pairs] for pairs in each}


def overlapping(factors: Factors) -> list[str]:
    """Return a line for each key that two factors set: one of them would count for nothing."""
    keys = {name: {key for level in levels.values() for key in flat(level)} for name, levels in factors.items()}
    found = ((one, two, sorted(keys[one] & keys[two])) for one, two in combinations(keys, 2))
    return [
        f"factors {one} and {two} both set {', '.join(both)}: must set different keys"
        for one, two, both in found
        if both
    ]


def planned(
    compare: Mapping[str, Any], factors: Factors, scenarios: Sequence[str]
) -> tuple[PlannedComparisons | None, list[str]]:
    """Check ``[compare]`` of a study file.

    Parameters
    ----------
    compare
        Its keys: ``outcomes``, a list; on request ``measures``, ``correction``; ``effect``, a factor, on request ``by``
        another one; ``contrasts``, a table for each question with the weights of scenarios; one of the two at least.
    factors
        Of the study.
    scenarios
        Their names, also those that the factors make.

    Returns
    -------
    plan, lines
        No plan, and what is wrong with it; or the plan and no lines. ``effect`` gives the difference of each level and
        the first one; with ``by``, at each level of that factor, and the differences of these: the interaction. Other
        factors are averaged.
    """
    from tissue.study.outcomes import EXTENTS

    lines = [
        unknown(f"compare.{key}", compare[key], [f"compare.{one}" for one in KEYS])
        for key in compare
        if key not in KEYS
    ]
    outcomes = [*get_args(What), *EXTENTS, *SHARES, *(one.column for one in registered(Observable))]
    chosen = _some("outcomes", compare.get("outcomes"), outcomes, lines)
    measures = _some("measures", compare.get("measures", ["difference"]), get_args(Measure), lines)
    correction = compare.get("correction", "simultaneous")
    if correction not in get_args(Correction):
        lines.append(_line("correction", correction, f"one of {', '.join(get_args(Correction))}"))
    contrasts = dict(_effects(compare, factors, lines))
    given = compare.get("contrasts", {})
    if not isinstance(given, Mapping) or not all(isinstance(one, Mapping) for one in given.values()):
        lines.append(_line("contrasts", given, "a table of weights of scenarios for each question"))
        given = {}
    for question, weights in given.items():
        lines += _faults(question, weights, scenarios)
        contrasts[question] = dict(weights)
    if not contrasts and not lines:
        lines.append(_line("effect", None, f"given, or contrasts; the factors are: {', '.join(factors) or 'none'}"))
    if lines:
        return None, lines
    return PlannedComparisons(tuple(chosen), tuple(measures), correction, contrasts), []


def _some(key: str, raw: Any, known: Sequence[str], lines: list[str]) -> list[Any]:
    """Return a list of different known names; a line is added where it is none."""
    if isinstance(raw, list) and raw and all(one in known for one in raw) and len(set(raw)) == len(raw):
        return raw
    lines.append(_line(key, raw, f"a list of some of {', '.join(known)}"))
    return []


def _effects(compare: Mapping[str, Any], factors: Factors, lines: list[str]) -> Iterator[tuple[str, Weights]]:
    """Give the contrasts of ``effect`` and ``by``."""
    effect, by = str(compare.get("effect", "")), compare.get("by")
    if not effect and by is None:
        return
    for key, name, allowed in (
        ("effect", effect, list(factors)),
        ("by", by, [one for one in factors if one != effect]),
    ):
        if name not in allowed and (key == "effect" or name is not None):
            lines.append(_line(key, name, f"one of the factors: {', '.join(allowed) or 'there are none'}"))
            return
    first, *others = factors[effect]
    at_levels: list[str | None] = [None] if by is None else list(factors[by])
    for level in others:
        simple = {at: _simple(factors, effect, (first, level), by, at) for at in at_levels}
        for at, weights in simple.items():
            yield f"{level} - {first}" + (f", {at}" if by else ""), weights
        base, *rest = simple
        for at in rest:
            weights = {**simple[at], **{name: -weight for name, weight in simple[base].items()}}
            yield f"({level} - {first}, {at}) - ({level} - {first}, {base})", weights


def _simple(factors: Factors, effect: str, pair: tuple[str, str], by: str | None, at: str | None) -> Weights:
    """Return the weights of the second level minus the first one of a factor, averaged over what is not fixed."""
    names, weights = list(factors), {}
    for levels in product(*factors.values()):
        here = dict(zip(names, levels, strict=True))
        if here[effect] in pair and (by is None or here[by] == at):
            weights[", ".join(levels)] = 1.0 if here[effect] == pair[1] else -1.0
    return {name: weight / (len(weights) / 2) for name, weight in weights.items()}


def _faults(question: str, weights: Mapping[str, Any], scenarios: Sequence[str]) -> Iterator[str]:
    """Give a line for each scenario of a contrast that is unknown, and for weights that are none."""
    key = f"contrasts.{describe(question)}"
    for name in weights:
        if name not in scenarios:
            yield _line(f"{key}.{describe(name)}", weights[name], f"the weight of a scenario: {', '.join(scenarios)}")
    values = list(weights.values())
    numbers = [
        one for one in values if isinstance(one, int | float) and not isinstance(one, bool) and math.isfinite(one)
    ]
    balanced = len(numbers) == len(values) and any(numbers) and abs(math.fsum(numbers)) < 1e-9
    if not balanced:
        yield _line(key, dict(weights), "weights of two or more scenarios with the sum 0, such as 1 and -1")


def _line(key: str, value: Any, allowed: str) -> str:
    said = "is missing" if value is None else f"= {describe(value)}"
    return f"compare.{key} {said}: must be {allowed}"
