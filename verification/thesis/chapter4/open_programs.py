"""More runs of the scenarios of which the other studies have too few to decide a claim."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from tissue.study.plan import TissueStudy, load_study
from verification.thesis.chapter4.differences import ENERGIES, values_of


class MoreRuns(NamedTuple):
    """Further runs.

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


# By name. "inm", for (Q6): the programs with [B] and without [P] that leave open whether INM matters, by preset.
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


def study(name: str) -> TissueStudy:
    """Return a study of ``MORE``."""
    more = MORE[name]
    changes = {"numerics.keep": "6 h"} | (values_of("corrected", ENERGIES) if name.endswith("_corrected") else {})
    loaded = {source: load_study(source) for source in more.scenarios}
    scenarios = {
        scenario: loaded[source].scenarios[scenario].changed(changes)
        for source, names in more.scenarios.items()
        for scenario in names
    }
    title = f"More runs: {', '.join(more.scenarios)}"
    return TissueStudy(title, more.replicates, more.seed, (), scenarios, text="")
