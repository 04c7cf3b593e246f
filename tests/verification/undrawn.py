"""Chapters without their figures, which the tests of the report draw, of the complete studies."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from verification.site.context import Context


def draw_nothing(patch: pytest.MonkeyPatch) -> None:
    """Put a single dot in place of each figure."""
    patch.setattr(Context, "draw", _put_dot)


def _put_dot(context: Context, name: str, *_: Any, ending: str = ".png") -> Path:
    path = context.out / "figures" / f"{name}{ending}"
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.new("1", (1, 1)).save(path)
    return path
