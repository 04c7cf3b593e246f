"""Rows of one kind as compiled code reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class TableRows(NamedTuple):
    """Rows of one kind, m of them, as ``dincl.kernels.table`` has them; ``entries`` counts those of each row.

    ``numbers`` maps names of fields of ``kernels.table.ROW`` to arrays (m,); what is missing is zero.
    """

    numbers: dict[str, Any]
    entries: NDArray[np.int64]
    column: NDArray[np.int64]
    coefficient: NDArray[np.float64]
