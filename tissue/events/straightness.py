"""[S]: loss of straightness (section 2.2.3 of chapter 4)."""

from __future__ import annotations

from dincl.compile import inner
from tissue.kernels.store import Store
from tissue.model.numbers import Numbers


@inner
def begin(store: Store, i: int, numbers: Numbers) -> None:
    """The bending spring of cell i weakens, to 0 in the thesis."""
    store.cells.stiff_axb[i] = numbers.bent_stiffness
