"""Dialogs that ask for a name: parameters to save, a study to make; and the texts of these files."""

from __future__ import annotations

import json
import secrets
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from shlex import quote
from typing import TYPE_CHECKING

from nicegui import ui

from dincl.errors import InvalidProblem
from tissue.files.keys import all_keys
from tissue.files.parameter_files import flat, nested, written
from tissue.files.parameters import Parameters
from tissue.study.plan import StudyFile, checked
from verification.explore.folder import TOML

if TYPE_CHECKING:
    from verification.explore.session import Session
    from verification.explore.setting import Setting


def parameters_text(setting: Setting) -> str:
    """Write the text of a parameter file of a setting; its base is a preset, or a file in the same folder."""
    comments = {name: facts.comment for name, facts in all_keys(Parameters).items()}
    return f"base = {json.dumps(setting.base)}\n\n{written(nested(setting.changes), comments)}"


def study_text(
    title: str, settings: Mapping[str, Setting], replicates: int, seed: int, remarks: Iterable[str] = ()
) -> str:
    """Return a study file with a scenario for each setting, and remarks above it.

    Replicate k of a scenario has the seed that the page gives it with this seed and the same names.

    Raises
    ------
    InvalidProblem
        If a setting lacks what the base of the first one has, such as a type of cells; or title or replicates are bad.
    """
    first = next(iter(settings.values()))
    head = {"title": title, "base": first.base, "replicates": replicates, "seed": seed}
    lines = "".join(f"{key} = {json.dumps(value, ensure_ascii=False)}\n" for key, value in head.items())
    scenarios = {name: _changes(setting.parameters, first.first) for name, setting in settings.items()}
    head_lines = "".join(f"# {remark}\n" for remark in remarks)
    text = head_lines + "\n".join([lines, *(_scenario(name, changes) for name, changes in scenarios.items())])
    checked(StudyFile, tomllib.loads(text), "study")
    return text


def looked_at(runs: Mapping[str, int], seed: int) -> list[str]:
    """Return remarks in a study file: which data were looked at before it was written."""
    there = " and ".join(f"{count} runs of {name}" for name, count in runs.items())
    return [
        f"Written on the page to explore after a look at {there}, with seed = {seed}.",
        "The runs of this study have another seed: they are not those that were looked at. What it compares was chosen",
        "by what those showed; an answer counts for what these runs show alone.",
    ]


def command(file: str) -> str:
    """Return the command line that carries out a study file; it goes on after any interruption."""
    folder = f"results/{file.removesuffix(TOML)}"
    return f"tissue study {quote(file)} --out {quote(folder)}"


def _changes(parameters: Parameters, base: Parameters) -> dict[str, object]:
    """Return the values in which parameters differ from their base, by key."""
    before, now = flat(base.as_dict()), flat(parameters.as_dict())
    if gone := sorted(set(before) - set(now)):
        raise InvalidProblem(f"{', '.join(gone)}: must be in both settings; open them from one file to compare them")
    return {key: value for key, value in now.items() if value != before.get(key)}


def _scenario(name: str, changes: Mapping[str, object]) -> str:
    table = f"scenarios.{name}"
    if not changes:
        return f"[{table}]\n"
    return written({f"{table}.{section}": values for section, values in nested(changes).items()}, {})


Done = Callable[[], object]


def save_parameters(session: Session, saved: Done) -> None:
    """Ask for a name, and save a parameter file."""

    def save() -> str:
        path = session.folder.save(name.value or "", parameters_text(session.now.setting))
        saved()
        return f"{path.name} is saved in the folder {path.parent.name}."

    with _dialog("Save the parameters", "Save", save):
        name = ui.input("name of the file", value="my_tissue.toml").props("dense outlined")


def make_study(session: Session) -> None:
    """Ask for a name, write a study with new seeds of what is on the page, and show the command that carries it out."""
    sides = [side for side in (session.held, session.now) if side is not None]
    there = max((side.answer.runs for side in sides if side.answer is not None), default=session.most)

    def make() -> str:
        settings = {side.name: side.setting for side in sides}
        seen = {side.name: 0 if side.answer is None else side.answer.runs for side in sides}
        new = secrets.randbits(32)  # so that nobody has looked at its runs
        remarks = looked_at(seen, session.seed)
        text = study_text(title.value or "", settings, int(runs.value or 0), new, remarks)
        return command(session.folder.save(name.value or "", text).name)

    with _dialog("Make this a study", "Write the file", make):
        title = ui.input("title", value="From the page").props("dense outlined")
        name = ui.input("name of the file", value="my_study.toml").props("dense outlined")
        runs = ui.number("runs of each setting", value=there, min=1, step=1, format="%d").props("dense outlined")


@contextmanager
def _dialog(title: str, action: str, act: Callable[[], str]) -> Iterator[None]:
    """Open a dialog around fields; what ``act`` returns, or what it refuses, is shown below."""

    def tried() -> None:
        try:
            said.text = act()
        except InvalidProblem as error:
            said.text = str(error)

    with ui.dialog(value=True) as dialog, ui.card().classes("dialog"):
        ui.label(title).classes("title")
        fields = ui.element("div").classes("fields")
        said = ui.label().classes("command").props('role="status"')
        with ui.element("div").classes("row"):
            ui.button(action, on_click=tried).props("dense no-caps")
            ui.button("Close", on_click=dialog.close).props("dense no-caps flat")
    dialog.on("hide", dialog.delete)
    with fields:
        yield
