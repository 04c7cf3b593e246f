"""Studies: files that name scenarios, each a change of the parameters, and say how often each of them is run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.events.known import events
from tissue.files.messages import refuse
from tissue.files.own_modules import placed
from tissue.files.parameter_files import flat, merged, read
from tissue.files.parameters import NoBase, Parameters, based_on
from tissue.study.shape import checked
from tissue.study.wording import in_scenarios, waits

FOLDER = Path(__file__).parent.parent / "studies"
# Replicates of one scenario that are computed and stored together, in lots of eight side by side.
PART = 128


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
    """What a study file says, made by ``load_study``."""

    title: str
    replicates: int  # of each scenario
    seed: int
    trajectories: tuple[int, ...]  # the replicates whose kept states are all stored
    scenarios: Mapping[str, Parameters]
    text: str  # the file

    @property
    def runs(self) -> int:
        """How many runs there are."""
        return self.replicates * len(self.scenarios)

    @property
    def remarks(self) -> list[str]:
        """One sentence for each scenario in which an event may come before the one for which it waits, as [P] for [B].

        Source: section 2.2.4 of chapter 4.
        """
        return in_scenarios({name: _waiting(parameters) for name, parameters in self.scenarios.items()})

    def pieces(self) -> Iterator[Piece]:
        """All pieces, one scenario after the other."""
        for name in self.scenarios:
            for first in range(0, self.replicates, PART):
                yield Piece(name, first, min(PART, self.replicates - first))


def load_study(path: str | PathLike[str]) -> TissueStudy:
    """The study in a TOML file.

    Its keys: ``title``; ``base``, a preset or the path of a parameter file, relative to this one; ``replicates`` of
    each scenario; ``seed``; on request ``trajectories``, a list of the replicates whose kept states are all stored,
    and ``[overrides.SECTION]``, parameters of all scenarios; ``[scenarios.NAME]``, at least one, with the parameters of
    its own, sections as keys.

    Parameters
    ----------
    path
        The file, or the name of a study that comes with this package.

    Raises
    ------
    InvalidProblem
        If there is no such file, or it cannot be read, lacks a key, has an unknown or a bad one, or a scenario that
        cannot be; all of it in one message that names the file, the scenario, each key, its value and what is allowed.
    """
    path = _found(path)
    tables = read(path)
    good, lines = checked(tables)
    scenarios: dict[str, Parameters] = {}
    base = _base(good["base"], path.parent, lines) if "base" in good else None
    if base is not None and "scenarios" in good:
        wrong: dict[str, list[str]] = {}
        for name, table in good["scenarios"].items():
            given = merged(good["overrides"], table)
            changed = _changed(base, placed(given, path.parent, base.own.modules))
            wrong[name] = changed if isinstance(changed, list) else []
            if isinstance(changed, Parameters):
                scenarios[name] = changed
        lines += in_scenarios(wrong)
    if lines:
        raise refuse(str(path), lines)
    plain = {key: good[key] for key in ("title", "replicates", "seed", "trajectories")}
    return TissueStudy(**plain, scenarios=scenarios, text=path.read_text("utf-8"))


def shipped() -> list[str]:
    """The names of the studies that come with this package."""
    return sorted(file.stem for file in FOLDER.glob("*.toml"))


def _waiting(parameters: Parameters) -> list[str]:
    """The events that wait."""
    found, marks = [], {event.name: event.mark for event in events()}
    for times in (dict(group.scenario.times) for group in parameters.groups()):
        pairs = ((event.name, event.after) for event in events() if event.name in times and event.after in times)
        found += [line for one, two in pairs for line in waits(marks[one], times[one], marks[two], times[two])]
    return list(dict.fromkeys(found))


def _found(path: str | PathLike[str]) -> Path:
    """The file, or the study of this name that comes with the package."""
    names, found = shipped(), checked_path("study", path)
    if not found.exists() and str(path) in names:
        return FOLDER / f"{path}.toml"
    if not found.exists():
        raise InvalidProblem(f"{path}: there is no such file; must be a TOML file, or a study: {', '.join(names)}")
    return found


def _base(base: str, folder: Path, lines: list[str]) -> Parameters | None:
    """The parameters that all scenarios change; None if there are none, and lines that say why."""
    try:
        return based_on(base, folder)
    except (NoBase, InvalidProblem) as error:
        lines.append(str(error).replace("\n", "\n  "))
        return None


def _changed(base: Parameters, tables: Mapping[str, Any]) -> Parameters | list[str]:
    """The parameters of a scenario, or what is wrong with them, line by line."""
    try:
        return base.changed(flat(tables))
    except InvalidProblem as error:
        first, *lines = str(error).split("\n  ")
        return lines or [first.partition(": ")[2]]
