"""Studies: runs that are named by keys, made by any executor, in tables that can be resumed.

It needs pandas, pyarrow and rich, which ``import dincl`` does not load.
"""

from dincl.study.execute import StudyStopped, carry_out, locked, progress, workers
from dincl.study.sealed import DamagedTable, read_sealed
from dincl.study.table import Key, Row, Study, digest, joined, write

__all__ = ["DamagedTable", "Key", "Row", "Study", "StudyStopped"]
__all__ += ["carry_out", "digest", "joined", "locked", "progress", "read_sealed", "workers", "write"]
