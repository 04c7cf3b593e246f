"""Pages from templates, put in place at once."""

from __future__ import annotations

from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from dincl.files import write_text
from verification.site.formulas import marked, typeset


def render_page(template: str, path: Path, **values: Any) -> Path:
    """Fill a template of this folder and put the page in place; ``made`` is the time."""
    made = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, typeset(render(template, made=made, **values)))
    return path


def render(template: str, **values: Any) -> str:
    """Return a template of this folder, filled; ``safe`` marks HTML as such, ``marked`` its formulas."""
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
    made.filters |= {"marked": marked, "counted": counted}
    return made


def counted(count: int, one: str, many: str = "") -> str:
    """Return a number with its noun, ``1 claim`` or ``2 claims``; ``many`` is the plural if it is not ``one`` + s."""
    return f"{count} {one if count == 1 else many or one + 's'}"
