"""Which studies are run, and how often each scenario in the short form."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from dincl.study import progress
from dincl.study.parts import fingerprint
from tissue.study.identity import identity
from tissue.study.plan import TissueStudy, load_study
from tissue.study.read import Results
from tissue.study.run import carry_out
from verification.thesis.chapter4 import differences, open_programs, sensitivity

NAMES = ("figure10", "figure12", "figure14", "figure15", "table5_63", "table5_35", "table5_7", "questions")


@dataclass(frozen=True)
class EmtForm:
    """Which studies are run.

    Attributes
    ----------
    replicates
        Of each scenario, by the name of the study; None: as its file says.
    changes
        Of the parameters of all scenarios, by the name of the study.
    """

    replicates: Mapping[str, int | None]
    changes: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


# Half of the replicates are where numbers are printed: fifteen seconds on two cores.
SHORT = EmtForm(
    {
        "figure10": 32,
        "figure12": 32,
        "figure14": 8,
        "figure15": 8,
        "table5_63": 24,
        "table5_35": 48,
        "table5_7": 24,
        "figure10_published": 32,
        "figure12_published": 32,
    }
)
# The studies of the model as printed with the energies of the preset "corrected", and fewer runs.
CORRECTED = {"figure10": 8000, "figure12": 400, "figure14": 400, "figure15": 200, "questions": 500}
CORRECTED |= {"table5_63": 4000, "table5_35": 16000, "table5_7": 4000}
# Studies that are none of the tables of the thesis.
FURTHER = {sensitivity.NAME: sensitivity.study} | {
    f"{differences.NAME}_{kind}": partial(differences.study, kind) for kind in differences.SETTINGS
}
PRESETS = {"thesis": "", "corrected": "_corrected", "published": "_published"}
# Studies that are made here, and do not come with the package.
MADE = FURTHER | {name: partial(open_programs.study, name) for name in open_programs.MORE}
FULL = EmtForm(
    dict.fromkeys((*NAMES, *(f"{name}_published" for name in NAMES), *MADE))
    | {f"{name}_corrected": replicates for name, replicates in CORRECTED.items()},
    {f"{name}_corrected": differences.values_of("corrected", differences.ENERGIES) for name in CORRECTED},
)


def preset_of(name: str) -> str:
    """The preset that a study changes."""
    return next(preset for preset, suffix in reversed(PRESETS.items()) if name.endswith(suffix))


def shortened(name: str, replicates: int) -> TissueStudy:
    """A study that comes with the package, with fewer replicates."""
    study = load_study(name)
    kept = tuple(number for number in study.trajectories if number < replicates)
    return replace(study, replicates=replicates, trajectories=kept)


def chosen(form: EmtForm) -> dict[str, TissueStudy]:
    """The studies of a form, by name."""
    return {name: _changed(_study(name, given), form.changes.get(name)) for name, given in form.replicates.items()}


def _study(name: str, replicates: int | None) -> TissueStudy:
    if name in MADE:
        return MADE[name]()
    name = name.removesuffix(PRESETS["corrected"])
    return load_study(name) if replicates is None else shortened(name, replicates)


def _changed(study: TissueStudy, changes: Mapping[str, Any] | None) -> TissueStudy:
    if not changes:
        return study
    return replace(study, scenarios={name: given.changed(changes) for name, given in study.scenarios.items()})


def place(name: str, study: TissueStudy, folder: Path) -> Path:
    """Where the results of this version of the study and of the code are; those with fewer replicates elsewhere."""
    made = {"replicates": study.replicates, **identity(study)}
    return folder / f"{name}-{fingerprint(made)[:12]}"


def completed(
    studies: Mapping[str, TissueStudy],
    folder: Path,
    executor: Executor | None,
    watch: Callable[[str, int], None] | None = None,
) -> dict[str, Results]:
    """Make the runs that are missing in ``folder``; ``watch`` is told the study and how many of its runs are there."""
    results = {}
    for name, study in studies.items():
        folder.mkdir(parents=True, exist_ok=True)
        seen = None if watch is None else lambda done, name=name: watch(name, done)
        results[name] = carry_out(study, place(name, study, folder), executor, seen)
    return results


def watched(studies: Mapping[str, TissueStudy], folder: Path, executor: Executor | None) -> dict[str, Results]:
    """As ``completed``, with a bar for all studies together."""
    stored = dict.fromkeys(studies, 0)
    with progress("EMT", sum(study.runs for study in studies.values()), "runs") as told:

        def watch(name: str, done: int) -> None:
            stored[name] = done
            told(sum(stored.values()))

        return completed(studies, folder, executor, watch)
