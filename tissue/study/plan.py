"""Studies: files that name scenarios, each a change of the parameters, how often each is run, and what is compared."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from hashlib import sha256
from itertools import combinations, product
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args
from urllib.parse import quote

import numpy as np
from numpy.random import SeedSequence
from pydantic import AfterValidator, AllowInfNan, BaseModel, Field, Strict, ValidationError, model_validator

from dincl.checks import describe
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.files.groups import never_begun
from tissue.files.keys import refuse, unknown
from tissue.files.own_modules import placed
from tissue.files.parameter_files import flat, merged, read
from tissue.files.parameters import Parameters, based_on
from tissue.files.quantities import Allowed, count
from tissue.files.sections import Section
from tissue.kernels.lanes import WIDTH
from tissue.plugins import Observable, registered
from tissue.runs.columns import EXTENTS
from tissue.study.categories import CONTROL_SIDES, What
from tissue.study.outcomes import emt_count
from tissue.study.parts import Part

FOLDER = Path(__file__).parent.parent / "studies"
# Runs of a part at most, and cells of their tissues together, so that a part takes about a minute at most.
MOST_RUNS, MOST_CELLS = 32, 2048
MOST_REPLICATES = 10_000_000
# Bytes of the name of a folder, of which "scenario=" is part, that file systems take.
LONGEST_NAME = 255 - len("scenario=")
# Scenarios beyond which each is compared with the first one alone, where no contrast is named.
MOST_PAIRED = 6
SCENARIOS = 'at least one table, such as [scenarios."[A]"], of sections of parameters'
FACTORS = 'tables of two levels or more, such as [factors.time], early = { emt.ac = "6 h" }'
COMPARE = "a table: outcomes, and on request the factor effect, or contrasts"
WEIGHTS = "weights of two or more scenarios with the sum 0, such as 1 and -1"
Measure = Literal["difference", "ratio"]
Weights = dict[str, float]
Tables = dict[str, dict[str, Any]]
Factors = Mapping[str, Mapping[str, Mapping[str, Any]]]  # factor -> level -> parameters
Model = TypeVar("Model", bound=BaseModel)


def outcome_names() -> list[str]:
    """Return what may be compared: shares of EMT cells, numbers of each run, registered observables."""
    return [*get_args(What), *EXTENTS, *CONTROL_SIDES, *(one.column for one in registered(Observable))]


def _refused_if(bad: bool, reason: str = "") -> None:
    if bad:
        raise ValueError(reason)


def _one_line(text: str) -> str:
    _refused_if(not text.strip() or not text.isprintable())
    return text


def _named(tables: Tables) -> Tables:
    for name in tables:
        fits = name and name.isprintable() and len(quote(name, safe="")) <= LONGEST_NAME
        _refused_if(not fits, f"{describe(name)} is too long, empty or not printable")
    return tables


def _factors(factors: dict[str, Tables]) -> dict[str, Tables]:
    _refused_if(any(len(levels) < 2 for levels in factors.values()))
    crossings = math.prod(map(len, factors.values())) if factors else 0
    _refused_if(len(crossed(factors)) < crossings, "their names must make different scenarios")
    _named(crossed(factors))
    return factors


def _outcomes(names: tuple[str, ...]) -> tuple[str, ...]:
    _refused_if(not names or len(set(names)) < len(names) or not {*names} <= {*outcome_names()})
    return names


TEXT = (Strict(), AfterValidator(_one_line))
FACTOR = Allowed("one of the factors", "text")


class StudyFile(Section):
    """A study file."""

    title: Annotated[str, Allowed("a text of one line", "text", TEXT)]
    base: Annotated[str, Allowed("a preset or the path of a parameter file, relative to this one", "text", TEXT)]
    replicates: Annotated[int, count(MOST_REPLICATES)]
    seed: Annotated[int, count(2**63 - 1, least=0)]
    paired: Annotated[bool, Allowed("true or false", "flag", (Strict(),))] = False
    overrides: Annotated[Tables, Allowed("sections of parameters, such as [overrides.numerics]", "table")] = Field({})
    scenarios: Annotated[Tables, Allowed(SCENARIOS, "table", (AfterValidator(_named),))] = Field({})
    factors: Annotated[dict[str, Tables], Allowed(FACTORS, "table", (AfterValidator(_factors),))] = Field({})
    # A ``Compare``, which is checked later: it depends on scenarios, and on what the base registers.
    compare: Annotated[dict[str, Any] | None, Allowed(COMPARE, "table", (Field(min_length=1),))] = Field(
        None, validate_default=False
    )

    @model_validator(mode="after")
    def _together(self) -> StudyFile:
        none = not self.scenarios and not self.factors
        _refused_if(none, f"scenarios is missing: must be {SCENARIOS}")
        for name in crossed(self.factors).keys() & self.scenarios.keys():
            raise ValueError(
                f"scenarios.{describe(name)}: must have another name: levels of factors make this scenario"
            )
        keys = {
            name: {key for level in levels.values() for key in flat(level)} for name, levels in self.factors.items()
        }
        for one, two in combinations(keys, 2):
            both = sorted(keys[one] & keys[two])
            _refused_if(bool(both), f"factors {one} and {two} both set {', '.join(both)}: must set different keys")
        return self


class Compare(Section):
    """[compare]: what a study is made to compare."""

    outcomes: Annotated[
        tuple[str, ...],
        Allowed(lambda: f"a list of some of {', '.join(outcome_names())}", "list", (AfterValidator(_outcomes),)),
    ]
    measures: Annotated[tuple[Measure, ...], Allowed(f"a list of some of {', '.join(get_args(Measure))}", "list")] = (
        "difference",
    )
    effect: Annotated[str, FACTOR] = ""
    by: Annotated[str, FACTOR] = ""
    contrasts: Annotated[
        dict[str, dict[str, Annotated[float, Strict(), AllowInfNan(False)]]],
        Allowed("a table of weights of scenarios for each question", "table"),
    ] = Field({})


@dataclass(frozen=True)
class PlannedComparisons:
    """The comparisons that a study was made for; they are corrected together, for nothing else.

    Attributes
    ----------
    outcomes
        As in ``Results.values``: means over runs at the end are compared.
    measures
        Of shares of EMT cells: "difference" in points, "ratio"; other numbers are compared by differences.
    contrasts
        The weight of each scenario, by question.
    effects
        Of a question about an effect: the level, or scenario, and the one it is compared with; with ``by`` the level of
        that factor; and of an interaction the level of that factor which it is compared with.
    """

    outcomes: tuple[str, ...]
    measures: tuple[Measure, ...]
    contrasts: Mapping[str, Weights]
    effects: Mapping[str, tuple[str, ...]]

    @property
    def scenarios(self) -> list[str]:
        """All scenarios that have a weight."""
        return list(dict.fromkeys(name for weights in self.contrasts.values() for name in weights))

    @property
    def blocks(self) -> list[tuple[str, Measure]]:
        """Each outcome with each of its measures."""
        difference: tuple[Measure, ...] = ("difference",)
        measures = {one: self.measures if one in get_args(What) else difference for one in self.outcomes}
        return [(outcome, measure) for outcome, each in measures.items() for measure in each]

    @property
    def count(self) -> int:
        """The number of comparisons."""
        return len(self.blocks) * len(self.contrasts)


def all_pairs(
    names: Iterable[str],
    outcomes: tuple[str, ...] = get_args(What),
    measures: tuple[Measure, ...] = ("difference",),
) -> PlannedComparisons:
    """Return the comparisons of scenarios with those before them; of more than six with the first one alone."""
    first, *others = names
    few = len(others) < MOST_PAIRED
    every = list(combinations([first, *others], 2)) if few else [(first, one) for one in others]
    contrasts = {f"{later} - {before}": {later: 1.0, before: -1.0} for before, later in every}
    effects = {f"{later} - {before}": (later, before) for before, later in every}
    return PlannedComparisons(outcomes, measures, contrasts, effects)


@dataclass(frozen=True)
class TissueStudy:
    """A study as its file gives it, made by ``load_study``."""

    title: str
    replicates: int  # of each scenario
    seed: int
    scenarios: Mapping[str, Parameters]
    text: str  # the file
    compare: PlannedComparisons | None = None  # what it was made to compare
    paired: bool = False  # whether replicate k of every scenario has the same random numbers

    @property
    def runs(self) -> int:
        """The number of runs."""
        return self.replicates * len(self.scenarios)

    @property
    def remarks(self) -> list[str]:
        """One sentence for each event of a scenario that no run begins, as it ends before."""
        found = ((name, never_begun(one.groups(), one.t_end)) for name, one in self.scenarios.items())
        return [f"scenario {describe(name)}: {line}" for name, lines in found for line in lines]

    def seeds(self, part: Part) -> list[int]:
        """Return the seed of each run of a part."""
        return run_seeds(self.seed, "" if self.paired else part.scenario, part.replicates)


def load_study(path: str | PathLike[str]) -> TissueStudy:
    """Load the study in a TOML file.

    Its keys: ``title``; ``base``, a preset or the path of a parameter file, relative to this one; ``replicates`` of
    each scenario; ``seed``; on request ``paired = true``, with which replicate k of every scenario has the same random
    numbers, and ``[overrides.SECTION]``, parameters of all scenarios; ``[scenarios.NAME]``, at least one, with the
    parameters of its own, sections as keys. Or ``[factors.NAME]``, tables of levels: each combination is a scenario,
    such as "early, arc".

    On request ``[compare]``, what the study is made to compare: ``outcomes``, a list; ``measures``; ``effect``, a
    factor, and ``by``, another one; ``contrasts``, a table for each question with the weights of scenarios. ``effect``
    gives the difference of each level and the first one; with ``by``, at each level of that factor, and the differences
    of these: the interaction. Other factors are averaged. Without effect and contrasts all pairs of scenarios are
    compared, of more than six each with the first one.

    Parameters
    ----------
    path
        The file, or the name of a study that comes with this package.

    Raises
    ------
    InvalidProblem
        If there is no such file, or it cannot be read, lacks a key, has an unknown or a bad one, a scenario that
        cannot be, or compares shares of EMT cells of scenarios without any; the message names the file, the scenario,
        the key, its value and what is allowed.
    """
    path = _found(path)
    file = checked(StudyFile, read(path), str(path))
    try:
        base = based_on(file.base, path.parent)
    except InvalidProblem as error:
        raise InvalidProblem(f"{path}: {error}") from None
    scenarios = {}
    for name, table in {**crossed(file.factors), **file.scenarios}.items():
        given = placed(merged(file.overrides, table), path.parent, base.own.modules)
        try:
            scenarios[name] = base.changed(flat(given))
        except InvalidProblem as error:
            said = str(error).removeprefix("changed parameters: ")
            raise InvalidProblem(f"{path}: scenario {describe(name)}: {said}") from None
    compare = None
    if file.compare is not None:
        asked = checked(Compare, file.compare, str(path), "compare.")
        try:
            compare = _planned(asked, file.factors, scenarios)
        except InvalidProblem as error:
            raise InvalidProblem(f"{path}: {error}") from None
    head = file.title, file.replicates, file.seed, scenarios
    return TissueStudy(*head, path.read_text("utf-8-sig"), compare, file.paired)


def shipped() -> list[str]:
    """Return the names of the studies that come with this package."""
    return sorted(file.stem for file in FOLDER.glob("*.toml"))


def part_size(parameters: Parameters) -> int:
    """Return how many runs of a scenario are computed and stored together.

    Eight runs of a slice are simulated side by side, so it is a multiple of eight there; tissues in space are alone.
    """
    least = 1 if parameters.in_space else WIDTH
    runs = max(least, min(MOST_RUNS, MOST_CELLS // parameters.tissue.cells))
    return runs - runs % least


def run_seeds(study_seed: int, scenario: str, replicates: Iterable[int]) -> list[int]:
    """Draw an integer in [0, 2^63) for each replicate, a function of (study_seed, scenario, replicate) alone.

    Runs of different scenarios are independent, and another scenario in the study changes the seed of none. No scenario
    has the name "": it stands for all of them in a study whose replicates are paired.
    """
    name = np.frombuffer(sha256(scenario.encode()).digest(), dtype="<u4").tolist()
    found = (SeedSequence([*name, study_seed], spawn_key=(replicate,)) for replicate in replicates)
    return [int(one.generate_state(1, np.uint64)[0] >> np.uint64(1)) for one in found]  # as int64 in tables


def crossed(factors: Factors) -> dict[str, dict[str, Any]]:
    """Return a scenario for each combination of levels: its parameters, by its name, such as "early, arc"."""
    every = product(*(levels.items() for levels in factors.values())) if factors else ()
    return {", ".join(name for name, _ in pairs): reduce(merged, (table for _, table in pairs), {}) for pairs in every}


def checked(shape: type[Model], tables: Mapping[str, Any], source: str, section: str = "") -> Model:
    """Return the values of tables; raises InvalidProblem with each bad, missing and unknown key.

    ``source``: of the tables, for messages; ``section``: what stands before their keys, such as "compare.".
    """
    try:
        return shape.model_validate(tables)
    except ValidationError as error:
        lines = [_line(shape, item, tables, section) for item in error.errors(include_url=False)]
    raise refuse(source, dict.fromkeys(lines))


def _line(shape: type[BaseModel], item: Any, tables: Mapping[str, Any], section: str) -> str:
    if not item["loc"]:  # of several keys
        return str(item["ctx"]["error"])
    key = item["loc"][0]
    name = f"{section}{key}"
    if name == "own":
        return f"own = {describe(tables[key])}: put own.modules into the base, or under [overrides.own]"
    if item["type"] == "extra_forbidden":
        return unknown(name, tables[key], [f"{section}{one}" for one in shape.model_fields])
    allowed = next(one.words for one in shape.model_fields[key].metadata if isinstance(one, Allowed))
    if key not in tables:
        return f"{name} is missing: must be {allowed}"
    reason = str(item.get("ctx", {}).get("error", ""))
    return f"{name} = {describe(tables[key])}: must be {allowed}" + (f"; {reason}" if reason else "")


def _found(path: str | PathLike[str]) -> Path:
    """Return the file, or the study of this name that comes with the package."""
    names, found = shipped(), checked_path("study", path)
    if not found.exists() and str(path) in names:
        return FOLDER / f"{path}.toml"
    if not found.exists():
        raise InvalidProblem(f"{path}: there is no such file; must be a TOML file, or a study: {', '.join(names)}")
    return found


def _planned(asked: Compare, factors: Factors, scenarios: Mapping[str, Parameters]) -> PlannedComparisons:
    """Return the comparisons of [compare] of a study file; raises InvalidProblem for names that are not in it."""
    if asked.measures == ("ratio",) and (plain := [one for one in asked.outcomes if one not in get_args(What)]):
        allowed = f"must have 'difference', too: {', '.join(plain)} is no share of EMT cells, and has no ratio"
        raise InvalidProblem(f"compare.measures = ['ratio']: {allowed}")
    if not (asked.effect or asked.by or asked.contrasts):
        if len(scenarios) < 2:
            raise InvalidProblem(f"compare: must have two scenarios or more, there is {', '.join(scenarios)}")
        found = all_pairs(scenarios, asked.outcomes, asked.measures)
    else:
        questions = list(_effects(asked.effect, asked.by, factors)) if asked.effect or asked.by else []
        effects = {question: effect for question, _, effect in questions}
        for question, weights in asked.contrasts.items():
            key = f"compare.contrasts.{describe(question)}"
            if question in effects:
                raise InvalidProblem(f"{key}: must have another name: compare.effect asks a question of this name")
            _check_weights(key, weights, scenarios)
        contrasts = {question: weights for question, weights, _ in questions} | asked.contrasts
        found = PlannedComparisons(asked.outcomes, asked.measures, contrasts, effects)
    shares = [one for one in asked.outcomes if one in get_args(What)]
    bare = ", ".join(repr(name) for name in found.scenarios if not emt_count(scenarios[name]))
    if shares and bare:
        allowed = "must have EMT cells to count in each scenario that is compared; emt.cells, or an event of a type"
        raise InvalidProblem(f"compare.outcomes = {shares}: {allowed}, gives some to {bare}")
    shares = [one for one in asked.outcomes if one == "below" or one in CONTROL_SIDES]
    full = ", ".join(repr(name) for name in found.scenarios if emt_count(one := scenarios[name]) == one.tissue.cells)
    if shares and full:
        raise InvalidProblem(f"compare.outcomes = {shares}: must have control cells to compare with, unlike {full}")
    return found


def _effects(effect: str, by: str, factors: Factors) -> Iterator[tuple[str, Weights, tuple[str, ...]]]:
    """Give the questions of ``effect`` and ``by``, with weights, and with whose effect it is."""
    others = [one for one in factors if one != effect]
    for key, name, allowed in (("effect", effect, list(factors)), ("by", by, others)):
        if name not in allowed and (name or key == "effect"):
            names = ", ".join(allowed) or "there are none"
            raise InvalidProblem(f"compare.{key} = {describe(name)}: must be one of the factors: {names}")
    first, *levels = factors[effect]
    for level in levels:
        simple = {at: _simple(factors, effect, (first, level), by, at) for at in (factors[by] if by else ("",))}
        for at, weights in simple.items():
            yield f"{level} - {first}" + (f", {at}" if by else ""), weights, (level, first, *([at] if by else []))
        base, *rest = simple
        for at in rest:
            weights = {**simple[at], **{name: -weight for name, weight in simple[base].items()}}
            yield f"({level} - {first}, {at}) - ({level} - {first}, {base})", weights, (level, first, at, base)


def _simple(factors: Factors, effect: str, pair: Sequence[str], by: str, at: str) -> Weights:
    """Return the weights of the second level minus the first one of a factor, averaged over what is not fixed."""
    weights = {}
    for levels in product(*factors.values()):
        here = dict(zip(factors, levels, strict=True))
        if here[effect] in pair and (not by or here[by] == at):
            weights[", ".join(levels)] = 1.0 if here[effect] == pair[1] else -1.0
    return {name: weight / (len(weights) / 2) for name, weight in weights.items()}


def _check_weights(key: str, weights: Weights, scenarios: Mapping[str, Parameters]) -> None:
    """Refuse scenarios of a contrast that are unknown, and weights that are none."""
    for name in weights.keys() - scenarios.keys():
        allowed = f"the weight of a scenario: {', '.join(scenarios)}"
        raise InvalidProblem(f"{key}.{describe(name)} = {weights[name]:g}: must be {allowed}")
    if not any(weights.values()) or abs(math.fsum(weights.values())) >= 1e-9:
        raise InvalidProblem(f"{key} = {describe(weights)}: must be {WEIGHTS}")
