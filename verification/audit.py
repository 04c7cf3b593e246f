"""All of the audit: its studies by their names, and the pages of results that are made."""

from collections.abc import Callable, Mapping

from dincl.study import Study
from verification.methods import page as experiments
from verification.methods import studies as methods
from verification.methods.chart import page as chart
from verification.methods.decisions import section as decisions
from verification.methods.hard import page as hard
from verification.methods.stability import page as stability
from verification.site.report import Page
from verification.thesis import page as claims
from verification.thesis import studies as thesis
from verification.thesis.chapter1 import prox_constants as geometry
from verification.thesis.chapter3 import page as minimisers
from verification.thesis.chapter4 import page as transitions
from verification.thesis.chapter5 import page as meanfield
from verification.tissues import curved
from verification.tissues import studies as tissues
from verification.tissues.needs import page as needs
from verification.tissues.space import page as space

# Each makes a study; their tables ship. In the order in which they can be made.
STUDIES: Mapping[str, Callable[..., Study]] = {**methods.STUDIES, **thesis.STUDIES, **tissues.STUDIES}
# Modules with ``run`` and ``show``; what they write about is in docs/results. The claims read the tables of all others.
PAGES: tuple[Page, ...] = (
    *(experiments, chart, decisions, needs, stability, hard, geometry),
    *(minimisers, transitions, curved, space, meanfield, claims),
)
