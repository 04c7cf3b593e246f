"""The two ends of a layer, which are neighbours if the tissue is closed."""

from __future__ import annotations

from typing import Any

from dincl.compile import inner
from tissue.kernels.lanes import either, load, positive_bits, spread, store
from tissue.state.cells import Floats


@inner
def at_ends(inside: Floats, values: Floats, n: int) -> tuple[Any, Any]:
    """The values of the first and of the last cell of a layer, in each tissue; 0 if the layer is empty."""
    first, last, missing, i = spread(values, 0.0), spread(values, 0.0), spread(values, 1.0), 0
    while i < n and positive_bits(missing):
        here = load(inside, i)
        first = either(here * missing, load(values, i), first)
        missing = either(here, 0.0, missing)
        i += 1
    missing, i = spread(values, 1.0), n - 1
    while i >= 0 and positive_bits(missing):
        here = load(inside, i)
        last = either(here * missing, load(values, i), last)
        missing = either(here, 0.0, missing)
        i -= 1
    return first, last


@inner
def move_ends(inside: Floats, values: Floats, n: int, first: Any, last: Any) -> None:
    """Add to the values of the first and of the last cell of a layer."""
    missing, i = spread(values, 1.0), 0
    while i < n and positive_bits(missing):
        here, value = load(inside, i), load(values, i)
        store(values, i, either(here * missing, value + first, value))
        missing = either(here, 0.0, missing)
        i += 1
    missing, i = spread(values, 1.0), n - 1
    while i >= 0 and positive_bits(missing):
        here, value = load(inside, i), load(values, i)
        store(values, i, either(here * missing, value + last, value))
        missing = either(here, 0.0, missing)
        i -= 1
