"""Claims of the thesis: the quotation and the correction of each come from the text file of its chapter.

A file has one table per claim::

    [c2.lemma]
    quote = "one sentence or formula, as printed"
    [c2.lemma.correction]
    text = "what to read instead"
    effect = "a step of a proof"        # one of ``Effect``
    depends = "what else rests on the sentence"
    why = "the reason"
    place = 1409                        # line in the text of the thesis

Line breaks inside a text count as spaces.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from verification.claims import Claim, Correction, Effect, Evidence, Verdict
from verification.claims import claim as without_text


def claim(
    id: str,
    statement: str,
    source: str,
    recorded: Verdict = Verdict.HOLDS,
    **details: Any,
) -> Callable[[Callable[..., Evidence]], Claim]:
    """State a claim of the thesis above its check; ``details``: see ``verification.claim``."""
    text = _texts()[id]
    found = text.get("correction")
    correction = found and Correction(**found | {"effect": Effect(found["effect"])})
    details |= {"source": source, "recorded": recorded, "quote": text["quote"], "correction": correction}
    return without_text(id, statement, **details)


@cache
def _texts() -> dict[str, dict[str, Any]]:
    """Read all files: id -> quotation and, if there is one, correction.

    Raises
    ------
    KeyError
        If two files have one id.
    """
    found: dict[str, dict[str, Any]] = {}
    for file in sorted(Path(__file__).parent.glob("*.toml")):
        for chapter, claims in tomllib.loads(file.read_text("utf-8")).items():
            for name, text in claims.items():
                if f"{chapter}.{name}" in found:
                    raise KeyError(f"{file.name}: {chapter}.{name} is there twice")
                found[f"{chapter}.{name}"] = _on_one_line(text)
    return found


def _on_one_line(value: Any) -> Any:
    """Replace line breaks by spaces, in tables within tables, too."""
    if isinstance(value, dict):
        return {name: _on_one_line(inside) for name, inside in value.items()}
    return " ".join(value.split()) if isinstance(value, str) else value
