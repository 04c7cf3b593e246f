"""Studies: files that name scenarios, each a change of the parameters, and say how often each of them is run."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.random import SeedSequence

from dincl.checks import describe
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.files.messages import refuse
from tissue.files.own_modules import placed
from tissue.files.parameter_files import flat, merged, read
from tissue.files.parameters import NoBase, Parameters, based_on
from tissue.files.scenario import remarks
from tissue.files.unread import idle_keys, idle_values
from tissue.statistics.categories import What
from tissue.study.planned import PlannedComparisons, combined, crossed, overlapping, planned
from tissue.study.shape import checked

FOLDER = Path(__file__).parent.parent / "studies"
# Replicates of one scenario that are computed and stored together, in batches of eight side by side.
PART = 128
# A table with both is of a sheet.
SHEET = ("tissue.dimension", "tissue.cells")


class Piece(NamedTuple):
    """Consecutive replicates of one scenario, which are computed and stored together."""

    scenario: str
    first: int
    runs: int

    @property
    def replicates(self) -> range:
        """The numbers of its replicates."""
        return range(self.first, self.first + self.runs)


@dataclass(frozen=True)
class TissueStudy:
    """A study as its file gives it, made by ``load_study``."""

    title: str
    replicates: int  # of each scenario
    seed: int
    trajectories: tuple[int, ...]  # the replicates whose saved states are all stored
    scenarios: Mapping[str, Parameters]
    text: str  # the file
    compare: PlannedComparisons | None = None  # what it was made to compare
    given_cells: Mapping[str, int] = field(default_factory=dict)  # of scenarios that a dimension gave another number

    @property
    def runs(self) -> int:
        """The number of runs."""
        return self.replicates * len(self.scenarios)

    @property
    def remarks(self) -> list[str]:
        """One sentence for each event of a scenario that waits for another one, or that the run may end before.

        Also for numbers of cells that a dimension changed, and for keys that nothing reads.
        """
        found = {name: [*remarks(one.groups(), one.t_end), *idle_keys(one)] for name, one in self.scenarios.items()}
        for name, given in self.given_cells.items():
            taken = f"tissue.cells = {self.scenarios[name].tissue.cells} fill the rows in three dimensions"
            found[name].insert(0, f"{taken}; {given} are those of a slice")
        return [*in_scenarios(found), *_alike(self.scenarios)]

    def pieces(self) -> Iterator[Piece]:
        """Give all pieces, one scenario after the other."""
        for name in self.scenarios:
            yield from around(name, [], self.replicates)


def load_study(path: str | PathLike[str]) -> TissueStudy:
    """Load the study in a TOML file.

    Its keys: ``title``; ``base``, a preset or the path of a parameter file, relative to this one; ``replicates`` of
    each scenario; ``seed``; on request ``trajectories``, a list of the replicates whose saved states are all stored,
    and ``[overrides.SECTION]``, parameters of all scenarios; ``[scenarios.NAME]``, at least one, with the parameters of
    its own, sections as keys. Or ``[factors.NAME]``, tables of levels: each combination is a scenario, such as
    "early, arc". On request ``[compare]``, what the study is made to compare: see ``tissue.study.planned``.

    Parameters
    ----------
    path
        The file, or the name of a study that comes with this package.

    Raises
    ------
    InvalidProblem
        If there is no such file, or it cannot be read, lacks a key, has an unknown or a bad one, a scenario that
        cannot be, or compares ratios of EMT cells of scenarios without any; all of it in one message that names the
        file, the scenario, each key, its value and what is allowed.
    """
    path = _found(path)
    tables = read(path)
    good, lines = checked(tables)
    scenarios: dict[str, Parameters] = {}
    given_cells: dict[str, int] = {}
    base = _base(good["base"], path.parent, lines) if "base" in good else None
    compare = None
    if base is not None and "scenarios" in good and "factors" in good:
        wrong: dict[str, list[str]] = {}
        lines += overlapping(good["factors"])
        parts = combined(good["factors"]) | {name: [table] for name, table in good["scenarios"].items()}
        tables = crossed(good["factors"]) | good["scenarios"]
        for name, table in tables.items():
            given = merged(good["overrides"], table)
            together = any({*SHEET} <= flat(one).keys() for one in (good["overrides"], *parts[name]))
            changed = _changed(base, placed(given, path.parent, base.own.modules), together=together)
            wrong[name] = changed if isinstance(changed, list) else []
            if isinstance(changed, Parameters):
                scenarios[name] = changed
                cells = flat(given).get("tissue.cells", changed.tissue.cells)
                given_cells |= {name: cells} if cells != changed.tissue.cells else {}
        lines += in_scenarios(wrong)
        if good.get("compare") is not None:
            compare, faults = planned(good["compare"], good["factors"], list(tables))
            lines += faults
            if compare is not None and not lines:
                lines += _without_cells(compare, scenarios)
    if lines:
        raise refuse(str(path), lines)
    plain = {key: good[key] for key in ("title", "replicates", "seed", "trajectories")}
    text = path.read_text("utf-8-sig")
    return TissueStudy(**plain, scenarios=scenarios, text=text, compare=compare, given_cells=given_cells)


def shipped() -> list[str]:
    """Return the names of the studies that come with this package."""
    return sorted(file.stem for file in FOLDER.glob("*.toml"))


def run_seeds(study_seed: int, scenario: str, replicates: Iterable[int]) -> list[int]:
    """Draw an integer in [0, 2^63) for each replicate, a function of (study_seed, scenario, replicate) alone.

    Runs of different scenarios are independent, and another scenario in the study changes the seed of none.
    """
    name = np.frombuffer(sha256(scenario.encode()).digest(), dtype="<u4")
    return [_seed([*name.tolist(), study_seed], replicate) for replicate in replicates]


def around(scenario: str, stored: Sequence[Piece], replicates: int) -> Iterator[Piece]:
    """Give the pieces that are stored, and between and behind them those that are missing, in order.

    Missing ones end at multiples of PART, so that equal studies have equal files.

    Parameters
    ----------
    scenario
        Whose.
    stored
        In any order; of pieces that overlap the first one counts.
    replicates
        All of the scenario.
    """
    first = 0
    for piece in (*sorted(stored, key=lambda one: one.first), Piece(scenario, replicates, 0)):
        if piece.first < first:
            continue
        while first < piece.first:
            last = min(piece.first, (first // PART + 1) * PART)
            yield Piece(scenario, first, last - first)
            first = last
        if piece.runs and piece.first < replicates:
            yield piece
            first += piece.runs


def in_scenarios(lines: Mapping[str, list[str]]) -> list[str]:
    """Return the lines about each scenario with its name, those about all of them once."""
    everywhere = set.intersection(*map(set, lines.values())) if len(lines) > 1 else set()
    common = [f"every scenario: {line}" for line in next(iter(lines.values()), []) if line in everywhere]
    others = ((name, line) for name, found in lines.items() for line in found if line not in everywhere)
    own = [f"scenario {describe(name)}: {line}" for name, line in others]
    return common + own


def _found(path: str | PathLike[str]) -> Path:
    """Return the file, or the study of this name that comes with the package."""
    names, found = shipped(), checked_path("study", path)
    if not found.exists() and str(path) in names:
        return FOLDER / f"{path}.toml"
    if not found.exists():
        raise InvalidProblem(f"{path}: there is no such file; must be a TOML file, or a study: {', '.join(names)}")
    return found


def _without_cells(compare: PlannedComparisons, scenarios: Mapping[str, Parameters]) -> Iterator[str]:
    """Yield a line if ratios of EMT cells are compared in scenarios that have none."""
    ratios = [one for one in compare.outcomes if one in get_args(What)]
    groups = {name: scenarios[name].groups() for name in compare.scenarios}
    bare = [name for name, each in groups.items() if not any(one.may_leave and one.scenario.cells for one in each)]
    if ratios and bare:
        yield (
            f"compare.outcomes = {ratios}: must have EMT cells to count in each scenario that is compared; "
            f"emt.cells, or an event of a type, gives some to {', '.join(map(repr, bare))}"
        )


def _base(base: str, folder: Path, lines: list[str]) -> Parameters | None:
    """Load the parameters that all scenarios change; None if there are none, and lines that say why."""
    try:
        return based_on(base, folder)
    except (NoBase, InvalidProblem) as error:
        lines.append(str(error).replace("\n", "\n  "))
        return None


def _alike(scenarios: Mapping[str, Parameters]) -> Iterator[str]:
    """Yield a sentence for the scenarios that differ, but in keys alone that nothing reads."""
    alike: dict[str, dict[str, str]] = {}
    for name, one in scenarios.items():
        whole = flat(one.as_dict())
        read = {key: value for key, value in whole.items() if key not in dict(idle_values(one))}
        alike.setdefault(json.dumps(read, sort_keys=True), {})[name] = json.dumps(whole, sort_keys=True)
    for texts in alike.values():
        if len(set(texts.values())) > 1:
            yield f"scenarios {', '.join(map(describe, texts))} differ only in keys that nothing reads"


def _changed(base: Parameters, tables: Mapping[str, Any], *, together: bool) -> Parameters | list[str]:
    """Return the parameters of a scenario, or what is wrong with them, line by line.

    A dimension counts last where it must: then the cells that a study gives are those of a slice; but not where one
    table gives both ``together``.
    """
    changes = flat(tables)
    try:
        try:
            return base.changed(changes)
        except InvalidProblem:
            dimension = changes.pop("tissue.dimension", None)
            if dimension is None or base.in_space or together:
                raise
            with suppress(InvalidProblem):
                return base.changed(changes).changed({"tissue.dimension": dimension})
            raise
    except InvalidProblem as error:
        first, *lines = str(error).split("\n  ")
        return lines or [first.partition(": ")[2]]


def _seed(entropy: list[int], replicate: int) -> int:
    state = SeedSequence(entropy, spawn_key=(replicate,)).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))  # as int64 in tables
