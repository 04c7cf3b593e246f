"""Short runs of the third dimension: the whole way to its chapter in seconds."""

from collections.abc import Mapping

import pytest

from verification.beyond.space import choices, growth, strip, substeps

SHORT = {"tissue.cells": 36, "numerics.t_end": "1 h", "numerics.keep": "1 h"}
SPACE = (
    growth.SheetForm(2, (growth.GrowingLayer("free sheet", 36, growth.SOME, growth.FREE),)),
    choices.ChoicesForm(2, (choices.AS_SHIPPED,)),
    strip.StripForm(2, ("[A]",)),
    substeps.SheetSubstepsForm((4, 5, 10, 15, 20), 60, 2),
)


def shorten_space(patch: pytest.MonkeyPatch) -> None:
    """Fewer cells, and an hour of what else takes days."""
    patch.setattr(choices, "SHEET", choices.SHEET | SHORT | {"types.isolated.cells": 2})
    patch.setattr(strip, "COMMON", strip.COMMON | {"numerics.t_end": "1 h", "numerics.keep": "1 h"})
    for module in (choices, strip):
        patch.setattr(module, "EVENTS", {name: _early(changes) for name, changes in module.EVENTS.items()})
    small = {name: {**changes, "tissue.cells": 36} for name, changes in substeps.TISSUES.items()}
    patch.setattr(substeps, "TISSUES", small)
    patch.setattr(substeps, "KEPT", {"numerics.t_end": "1 h", "numerics.keep": ["0.2 h", "1 h"]})


def _early(changes: Mapping[str, object]) -> dict[str, object]:
    """Return the same events within the short run."""
    return {name: "0.5 h" if str(value).endswith(" h") else value for name, value in changes.items()}
