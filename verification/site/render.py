"""Parts of pages from the templates of this room."""

from __future__ import annotations

from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from verification.site.cells import formula


def render(template: str, **values: Any) -> str:
    """Return a template, filled; ``safe`` marks HTML as such, the filter ``formula`` sets scripts."""
    return _environment().get_template(template).render(safe=Markup, **values)


@cache
def _environment() -> Environment:
    made = Environment(
        loader=PackageLoader("verification.site"),
        autoescape=select_autoescape(),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["formula"] = lambda text: Markup(formula(text))
    return made
