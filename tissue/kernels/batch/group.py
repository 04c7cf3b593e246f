"""The stores of eight replicates as rows of common arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tissue.kernels.batch.rows import mapped
from tissue.kernels.lanes import WIDTH
from tissue.kernels.store import Store, grown


def grouped(stores: Sequence[Store]) -> Store:
    """Up to WIDTH stores of the same capacity as one store, a row each; places left over repeat the last."""
    rows = [*stores, *[stores[-1]] * (WIDTH - len(stores))]
    return mapped(lambda *arrays: np.stack(arrays), *rows)


def replicate(group: Store, k: int) -> Store:
    """Row k, a view."""
    return mapped(lambda array: array[k], group)


def grown_group(group: Store) -> Store:
    """The same cells and counters with twice the room."""
    return grouped([grown(replicate(group, k)) for k in range(WIDTH)])
