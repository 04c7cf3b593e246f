"""Session of one visitor: a setting with its ensemble, on request another one that is held beside it."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field
from string import ascii_uppercase
from typing import TYPE_CHECKING, Any

from dincl.checks import integer
from dincl.errors import InvalidProblem
from tissue.files.parameter_files import PRESETS
from tissue.study.plan import run_seeds
from verification.explore.common.folder import Folder
from verification.explore.tissues.answer import Answer, answer_of
from verification.explore.tissues.ensemble import Ensemble, PartialResults
from verification.explore.tissues.setting import Setting, faults_of

if TYPE_CHECKING:
    from collections.abc import Collection


MOST = 400  # runs of an ensemble, after which a page that is left open costs nothing
SEED = 0


def checked_seed(seed: int) -> int:
    """Check a seed as a study does."""
    return integer("seed", seed, least=0)


@dataclass
class Side:
    """A setting with what is known of it; ``ensemble`` is None for a scenario of a study that is stored."""

    name: str  # of the scenario
    setting: Setting
    ensemble: Ensemble | None
    answer: Answer | None = None

    @property
    def over(self) -> bool:
        """Whether no more runs will come."""
        return self.ensemble is None or self.ensemble.over

    def stop(self) -> None:
        """End its work."""
        if self.ensemble is not None:
            self.ensemble.stop()

    def is_behind(self) -> bool:
        """Return whether enough runs have come for another answer: half as many again, or the last ones."""
        known = 0 if self.answer is None else self.answer.runs
        runs = 0 if self.ensemble is None else self.ensemble.runs
        return runs > known and (self.over or (runs > 1 and 2 * runs >= 3 * known))

    def catch_up(self) -> None:
        """Take in the runs that there are."""
        grown = None if self.ensemble is None else self.ensemble.partial_results()
        if grown is not None:
            self.answer = answer_of(grown)


@dataclass
class Session:
    """The state of a page. Each change of the setting stops the runs of the one before at once."""

    folder: Folder
    pool: Executor
    now: Side
    seed: int = SEED
    most: int = MOST
    held: Side | None = None
    pending: dict[str, Any] = field(default_factory=dict)  # values that were not accepted, by key

    @classmethod
    def begin(cls, folder: Folder, pool: Executor, setting: Setting, seed: int = SEED) -> Session:
        """Begin a session with this setting and without runs."""
        session = cls(folder, pool, Side("A", setting, None), checked_seed(seed))
        session.use(setting)
        return session

    def set_values(self, values: Mapping[str, Any]) -> tuple[dict[str, str], list[str]]:
        """Change the setting where that is possible; what is wrong, by key, and what is wrong with the whole.

        Values that were refused before are tried again with these: two may only go together.
        """
        wanted = {**self.pending, **values}
        faults: tuple[dict[str, str], list[str]] = {}, []
        try:
            setting, self.pending = self.now.setting.with_values(wanted), {}
        except InvalidProblem as error:
            faults, setting = faults_of(error, list(wanted)), None
            self.pending = wanted
            try:
                setting = self.now.setting.with_values(values)
                self.pending = {key: value for key, value in wanted.items() if key not in values}
            except InvalidProblem:
                pass
        if setting is not None and setting.parameters != self.now.setting.parameters:
            self.use(setting)
        return faults

    def use(self, setting: Setting) -> None:
        """Take another setting in place of this one; ``start`` begins its runs."""
        self.now.stop()
        name = self.now.name
        self.now = Side(name, setting, Ensemble(setting.parameters, self.seed, name, self.most, self.pool))

    def bases(self) -> list[str]:
        """Return what a setting may begin with: the presets, and the parameter files of the folder."""
        return list(dict.fromkeys((*PRESETS, *self.folder.parameter_files())))

    def open(self, name: str) -> None:
        """Begin anew with a preset or a file of the folder."""
        setting, self.pending = Setting(name, self.folder.parameters(name, agreed=True)), {}
        self.use(setting)

    def reseed(self, seed: int) -> None:
        """Take other runs of the same settings."""
        self.seed = checked_seed(seed)
        self.release()
        self.use(self.now.setting)

    def start(self, most: int | None = None) -> None:
        """Begin the runs, or go on up to another number of them."""
        self.most = most or self.most
        for side in (self.now, self.held):
            if side is not None and side.ensemble is not None:
                side.ensemble.start(self.most)

    def hold(self) -> None:
        """Keep this setting to compare others with; these have seeds of their own."""
        self.release()
        self.held = self.now
        self._begin_beside({self.now.name})

    def open_study(self, name: str, scenario: str) -> None:
        """Hold the stored answer of a scenario, and begin with its parameters beside it."""
        results = self.folder.results(name)
        grown = PartialResults(results.cells(scenario), results.runs(scenario))
        setting = Setting.of(results.parameters(scenario))
        self.release()
        self.now.stop()
        self.held = Side(scenario, setting, None, answer_of(grown))
        self.now = Side(self.now.name, setting, None)
        self._begin_beside(results.study.scenarios)

    def release(self) -> None:
        """Compare no more."""
        if self.held is not None:
            self.held.stop()
        self.held = None

    def stop(self) -> None:
        """End all work."""
        self.release()
        self.now.stop()

    def seed_of(self, replicate: int) -> int:
        """Return the seed of a run of the ensemble."""
        return run_seeds(self.seed, self.now.name, [replicate])[0]

    def _begin_beside(self, names: Collection[str]) -> None:
        """Begin the same setting under another name: its runs are independent of the runs of these names."""
        self.now = Side(next(name for name in ascii_uppercase if name not in names), self.now.setting, None)
        self.use(self.now.setting)
