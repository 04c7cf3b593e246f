"""The ensembles of chapter 4, in three readings of the model: their scenarios, how often each is run, and the runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import pandas as pd

from tissue.files.parameter_files import flat
from tissue.files.parameters import Parameters, preset
from tissue.study.outcomes import outcomes
from tissue.study.plan import TissueStudy, load_study, run_seeds

# The ending of an ensemble, by the reading of the model that it is in.
PRESETS = {"thesis": "", "corrected": "_corrected", "published": "_published"}
# The keys in which "corrected" differs from "thesis": the energies of chapter 3 without their misprints.
ENERGIES = ("rules.spring_power", "rules.junction_factor", "rules.repulsion_factor")
ISOLATED = ("figure10", "figure12", "figure14")
# The studies of Table 5: heterogeneous groups.
POPULATIONS = {"table5_63": "63 % [P]", "table5_35": "35 % [P]", "table5_7": "7 % [P]"}
# The other studies that come with ``tissue`` and how often each scenario is run with corrected energies; with the
# other energies as often as their files say.
CORRECTED = {"figure10": 8000, "figure12": 400, "figure14": 400, "figure15": 200, "questions": 500}
CORRECTED |= {"table5_63": 4000, "table5_35": 16000, "table5_7": 4000}


class MoreRuns(NamedTuple):
    """Further runs of scenarios of which the other ensembles have too few to decide a claim.

    Attributes
    ----------
    scenarios
        By the study that they are of.
    replicates
        Of each: about what a difference of the size that the first runs measured needs.
    seed
        Another one than that of the first runs.
    """

    scenarios: Mapping[str, tuple[str, ...]]
    replicates: int
    seed: int


def _with_and_without(*programs: str) -> tuple[str, ...]:
    """Return programs with INM and without."""
    return tuple(program.format(inm) for program in programs for inm in ("", " no INM"))


# "inm", for (Q6): the programs with [B] and without [P] that leave open whether INM matters, by reading.
# "mixtures", for section 4.5.2: cells to which those of mixed groups are compared.
MORE = {
    "inm": MoreRuns({"figure15": _with_and_without("[AxB]{}", "[AxB]{}, 10 cells", "[xB]{}")}, 500, 601),
    "inm_published": MoreRuns(
        {
            "figure15_published": _with_and_without("[AxB]{}, 10 cells", "[BxA]{}"),
            "questions_published": _with_and_without("[AB]{}, 10 cells"),
        },
        800,
        602,
    ),
    "inm_corrected": MoreRuns({"figure15": _with_and_without("[AxB]{}, 10 cells")}, 1000, 603),
    "mixtures_published": MoreRuns(
        {"questions_published": ("[A] at any time no INM", "[A] and [B] at any time no INM, 10 cells")}, 1500, 604
    ),
}
NAMES = (*(name + ending for ending in PRESETS.values() for name in CORRECTED), *MORE)


def preset_of(name: str) -> str:
    """Return the reading that an ensemble is in."""
    return next(preset for preset, ending in reversed(PRESETS.items()) if name.endswith(ending))


def without_ending(name: str) -> str:
    """Return the name of an ensemble that is the same in all readings."""
    return name.removesuffix(PRESETS[preset_of(name)])


def values_of(name: str, keys: Iterable[str]) -> dict[str, Any]:
    """Return the values that a preset has for some keys."""
    values = flat(preset(name).as_dict())
    return {key: values[key] for key in keys}


@cache
def ensemble(name: str) -> TissueStudy:
    """Return an ensemble of ``NAMES``."""
    if name in MORE:
        return _more(name)
    if preset_of(name) != "corrected":
        return load_study(name)
    first = without_ending(name)
    return _changed(replace(load_study(first), replicates=CORRECTED[first]), values_of("corrected", ENERGIES))


def _more(name: str) -> TissueStudy:
    """Return further runs of some scenarios."""
    more = MORE[name]
    loaded = {source: load_study(source) for source in more.scenarios}
    scenarios = {each: loaded[source].scenarios[each] for source, names in more.scenarios.items() for each in names}
    changes = {"numerics.keep": "6 h"} | (values_of("corrected", ENERGIES) if name.endswith("_corrected") else {})
    title = f"More runs: {', '.join(more.scenarios)}"
    return _changed(TissueStudy(title, more.replicates, more.seed, scenarios, text=""), changes)


def _changed(study: TissueStudy, changes: Mapping[str, Any]) -> TissueStudy:
    return replace(study, scenarios={name: given.changed(changes) for name, given in study.scenarios.items()})


class Made(NamedTuple):
    """The EMT cells of the runs of a scenario, and the runs."""

    cells: pd.DataFrame
    runs: pd.DataFrame


def made(parameters: Parameters, seed: int, scenario: str, replicates: int) -> Made:
    """Make the runs of a scenario with the seeds that ``tissue study`` gives them in a study with this seed."""
    numbers = range(replicates)
    found = outcomes(parameters, numbers, run_seeds(seed, scenario, numbers))
    return Made(found.cells.to_pandas(), found.runs.to_pandas())


def scenario_of(study: str, scenario: str) -> Made:
    """Make all runs of a scenario of an ensemble."""
    plan = ensemble(study)
    return made(plan.scenarios[scenario], plan.seed, scenario, plan.replicates)
