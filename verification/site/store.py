"""Tables that come with the program: one Parquet file for each study, with what it was made by.

The attribute ``made`` of a table says the version of this package, those of libraries, settings and date. Whether a
table is still true is decided by making a part of its study again and laying it over (``verification.site.agreement``).
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from dincl.extras import tables_of_studies
from dincl.study import read_sealed

DATA = tables_of_studies() or Path(__file__).parents[1] / "data"


def shipped(name: str) -> pd.DataFrame:
    """Read the table of a study; DamagedTable if it is not as it was written."""
    return read_sealed(DATA / f"{name}.parquet")
