"""Ways to make an ingredient of a check wrong, for the tests that a check can fail."""

import re
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, NamedTuple

import pytest

from verification.claims import Claim, Evidence, Verdict
from verification.thesis.register import register

CLAIMS = {claim.id: claim for claim in register()}

Change = Callable[[Any], Any]


class Wrong(NamedTuple):
    """What is changed in a module of a chapter ("chapter1.cells"), how, and the verdict that follows."""

    module: str
    attributes: str | tuple[str, ...]
    change: Change
    verdict: Verdict = Verdict.REFUTED
    tables: Mapping[str, Any] = {}


def times(factor: float) -> Change:
    """A function whose values are off by a factor."""
    return lambda f: lambda *given, **named: factor * f(*given, **named)


def replaced(value: Any) -> Change:
    """Another constant or function."""
    return lambda _: value


def decided(claim: Claim, wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> Evidence:
    """What the check finds with the wrong ingredient."""
    chapter, name = wrong.module.split(".")
    folder = f"{chapter}.claims" if re.match(r"s\d", name) else chapter
    module = import_module(f"verification.thesis.{folder}.{name}")
    for attribute in (wrong.attributes,) if isinstance(wrong.attributes, str) else wrong.attributes:
        monkeypatch.setattr(module, attribute, wrong.change(getattr(module, attribute)))
    return claim.decide(wrong.tables)
