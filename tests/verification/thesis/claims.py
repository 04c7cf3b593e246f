"""The claims of the register by id, and tables with which one comes out otherwise."""

from collections.abc import Mapping
from typing import NamedTuple

import pandas as pd

from verification.claims import Verdict
from verification.thesis.register import register

CLAIMS = {claim.id: claim for claim in register()}


class Otherwise(NamedTuple):
    """Tables, and the verdict that follows from them."""

    tables: Mapping[str, pd.DataFrame]
    verdict: Verdict = Verdict.REFUTED
