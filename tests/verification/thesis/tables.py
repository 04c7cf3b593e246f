"""The claims of the register by id, and the tables that they read, as they ship."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import pandas as pd

from tests.executors import Nowhere
from verification.audit import STUDIES
from verification.site.context import Context
from verification.site.store import DATA
from verification.thesis.register import register, tables_for

CLAIMS = {claim.id: claim for claim in register()}


@cache
def shipped_tables() -> dict[str, pd.DataFrame]:
    """All tables that claims read, made from complete studies; nothing is run."""
    context = Context(Path(mkdtemp()), False, Nowhere(), STUDIES, complete=DATA)
    return dict(tables_for(CLAIMS.values(), context))
