"""Session of one visitor: a setting with its ensemble, on request another one that is held beside it."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Any

from dincl.checks import integer
from dincl.errors import InvalidProblem
from tissue.files.parameter_files import PRESETS
from tissue.study.plan import run_seeds
from verification.explore.answer import Answer, answer_of
from verification.explore.ensemble import Ensemble
from verification.explore.folder import Folder
from verification.explore.setting import Setting, faults_of

MOST = 400  # runs of an ensemble, after which a page that is left open costs nothing
SEED = 0


def checked_seed(seed: int) -> int:
    """Check a seed as a study does."""
    return integer("seed", seed, least=0)


@dataclass
class Side:
    """A setting with its runs and what is known of it."""

    name: str  # of the scenario
    setting: Setting
    ensemble: Ensemble
    answer: Answer | None = None

    def is_behind(self) -> bool:
        """Return whether enough runs have come for another answer: half as many again, or the last ones."""
        known, runs = 0 if self.answer is None else self.answer.runs, self.ensemble.runs
        return runs > known and (self.ensemble.over or (runs > 1 and 2 * runs >= 3 * known))

    def catch_up(self) -> None:
        """Take in the runs that there are."""
        if (found := self.ensemble.partial_results()) is not None:
            self.answer = answer_of(found)


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
        first = Ensemble(setting.parameters, checked_seed(seed), "A", MOST, pool)
        return cls(folder, pool, Side("A", setting, first), seed)

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
        self.now.ensemble.stop()
        self.now = self._side(self.now.name, setting)

    def _side(self, name: str, setting: Setting) -> Side:
        return Side(name, setting, Ensemble(setting.parameters, self.seed, name, self.most, self.pool))

    def bases(self) -> list[str]:
        """Return what a setting may begin with: the presets, and the parameter files of the folder."""
        return list(dict.fromkeys((*PRESETS, *self.folder.parameter_files())))

    def open(self, name: str) -> None:
        """Begin anew with a preset or a file of the folder."""
        setting, self.pending = Setting(name, self.folder.parameters(name)), {}
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
            if side is not None:
                side.ensemble.start(self.most)

    def hold(self) -> None:
        """Keep this setting to compare others with, which have another name: their runs are independent of its runs."""
        self.release()
        self.held = self.now
        self.now = self._side("B" if self.held.name == "A" else "A", self.held.setting)

    def release(self) -> None:
        """Compare no more."""
        if self.held is not None:
            self.held.ensemble.stop()
        self.held = None

    def stop(self) -> None:
        """End all work."""
        self.release()
        self.now.ensemble.stop()

    def seed_of(self, replicate: int) -> int:
        """Return the seed of a run of the ensemble."""
        return run_seeds(self.seed, self.now.name, [replicate])[0]
