"""All of the audit: its studies by the names of their tables, and the pages of results that are made."""

from collections.abc import Callable, Mapping

from dincl.study import Study
from verification.methods import large_steps, orders, proved, references, strengths
from verification.methods import page as experiments
from verification.methods.chart import programs as engines
from verification.methods.chart import references as charted
from verification.methods.chart import work_precision
from verification.methods.decisions import study as decisions
from verification.methods.hard import study as hard
from verification.methods.stability import page as stability
from verification.site.report import Page
from verification.thesis import page as claims
from verification.thesis.chapter1 import prox_constants as geometry
from verification.thesis.chapter3 import accuracy, daha, growth, substeps
from verification.thesis.chapter3 import page as minimisers
from verification.thesis.chapter3 import stability as steps
from verification.thesis.chapter4 import differences, groups, outcomes
from verification.thesis.chapter4 import page as transitions
from verification.thesis.chapter5 import page as meanfield
from verification.tissues import curved, fits
from verification.tissues.needs import study as needs
from verification.tissues.space import growth as grown
from verification.tissues.space import isolated, sheet
from verification.tissues.space import page as space

# Name -> the function ``study(smallest=False)``, in the order in which they can be made; the smallest form has some of
# the runs of the complete one, whose table ships.
STUDIES: Mapping[str, Callable[..., Study]] = {
    "references": references.study,
    "orders": orders.study,
    "penalty_scan": strengths.scan,
    "large_steps": large_steps.study,
    "proved_scenes": proved.chosen,
    "proved_random": proved.random,
    **stability.STUDIES,
    "work_references": charted.study,
    "work_precision": work_precision.study,
    "programs": engines.study,
    "decisions": decisions.study,
    "hard_scenes": hard.study,
    "tissue_substeps": substeps.study,
    "tissue_motion": accuracy.motion,
    "tissue_judged": accuracy.steps,
    "tissue_growth": growth.study,
    steps.NAME: steps.study,
    "tissue_daha": daha.study,
    "emt_in_time": outcomes.in_hours,
    "emt_ratios": outcomes.at_the_end,
    "emt_groups": groups.study,
    "emt_ranking": groups.ranking,
    "emt_effects": differences.effects,
    **meanfield.STUDIES,
    "space_growth": grown.study,
    "space_isolated": isolated.study,
    "space_sheet": sheet.study,
    "curved_ways_out": curved.study,
    "needs_answers": needs.study,
    "fit_coverage": fits.study,
}
# Modules with ``run`` and ``show``; what they write about is in docs/results. The claims read the tables of all others.
PAGES: tuple[Page, ...] = (
    *(experiments, work_precision, decisions, needs, stability, hard, geometry),
    *(minimisers, transitions, curved, space, meanfield, claims),
)
