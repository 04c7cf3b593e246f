"""Studies: runs that are named by keys, made by any executor, kept as tables that can be taken up again.

It needs pandas and pyarrow, which ``import dincl`` does not load.
"""

from dincl.study.bar import progress
from dincl.study.execute import carry_out, workers
from dincl.study.sealed import DamagedTable, read_sealed
from dincl.study.stopped import StudyStopped
from dincl.study.study import Key, Study
from dincl.study.table import Row, Table, digest, write

MAKES_NO_NUMBERS = True
__all__ = ["DamagedTable", "Key", "Row", "Study", "StudyStopped", "Table"]
__all__ += ["carry_out", "digest", "progress", "read_sealed", "workers", "write"]
