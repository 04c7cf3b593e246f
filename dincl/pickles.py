"""Which part of an object stands in the way when the whole is pickled."""

from __future__ import annotations

import pickle
from typing import Any

from dincl.checks import describe


def check_pickles(name: str, part: Any) -> None:
    """Raise PicklingError that names the innermost part that does not pickle, and says what to do."""
    try:
        pickle.dumps(part)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        for inner, value in getattr(part, "__dict__", {}).items():
            check_pickles(f"{name}.{inner}", value)
        raise pickle.PicklingError(
            f"{name} = {describe(part)}: cannot be pickled; define it at module level, or keep path.to_frame()"
        ) from error
