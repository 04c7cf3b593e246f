"""What is on the page as a study file, so that its numbers can be made again, and more of them."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from shlex import quote
from typing import TYPE_CHECKING

from dincl.errors import InvalidProblem
from tissue.explore.folder import RESULTS, TOML
from tissue.files.keys import all_keys
from tissue.files.messages import refuse
from tissue.files.parameter_files import flat, nested, written
from tissue.files.parameters import Parameters
from tissue.study.shape import checked

if TYPE_CHECKING:
    from tissue.explore.setting import Setting

MAKES_NO_NUMBERS = True


def parameters_text(setting: Setting) -> str:
    """A parameter file of a setting, with its base: it is to lie beside it, or that is a preset."""
    comments = {name: facts.comment for name, facts in all_keys(Parameters).items()}
    return f"base = {json.dumps(setting.base)}\n\n{written(nested(setting.changes), comments)}"


def study_text(title: str, settings: Mapping[str, Setting], replicates: int, seed: int) -> str:
    """A study file with a scenario for each setting.

    Its runs are those of the page: replicate k of a scenario has the seed that the page gives it by the same names.

    Raises
    ------
    InvalidProblem
        If a setting lacks what the base of the first one has, such as a type of cells; or title or replicates are bad.
    """
    first = next(iter(settings.values()))
    head = {"title": title, "base": first.base, "replicates": replicates, "seed": seed}
    lines = "".join(f"{key} = {json.dumps(value, ensure_ascii=False)}\n" for key, value in head.items())
    scenarios = {name: _changes(setting.parameters, first.first) for name, setting in settings.items()}
    text = "\n".join([lines, *(_scenario(name, changes) for name, changes in scenarios.items())])
    if faults := checked(tomllib.loads(text))[1]:
        raise refuse("study", faults)
    return text


def command(file: str) -> str:
    """The command line that carries out a study file; it goes on after any interruption."""
    folder = f"{RESULTS}/{file.removesuffix(TOML)}"
    return f"tissue study {quote(file)} --out {quote(folder)}"


def _changes(parameters: Parameters, base: Parameters) -> dict[str, object]:
    """The values in which parameters differ from their base, by key."""
    before, now = flat(base.as_dict()), flat(parameters.as_dict())
    if gone := sorted(set(before) - set(now)):
        raise InvalidProblem(f"{', '.join(gone)}: must be in both settings; open them from one file to compare them")
    return {key: value for key, value in now.items() if value != before.get(key)}


def _scenario(name: str, changes: Mapping[str, object]) -> str:
    table = f"scenarios.{name}"
    if not changes:
        return f"[{table}]\n"
    return written({f"{table}.{section}": values for section, values in nested(changes).items()}, {})
