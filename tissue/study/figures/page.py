"""One HTML page of a study that needs nothing else: answers with their pictures, tables, parameters, origin."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from dincl.errors import InvalidProblem
from dincl.files import read_bytes, write_text
from tissue.frames.observables import measurable
from tissue.pictures.movie import small_movie
from tissue.pictures.picture import stills
from tissue.pictures.sheet import Figure, png, style
from tissue.runs.simulate import simulate
from tissue.study.answers import control_shares, scenario_changes, scenario_differences, scenario_ratios
from tissue.study.comparing import answers_or_reason, correction_text, effect_text, plan_of
from tissue.study.figures.catalogue import drawables
from tissue.study.figures.effects import effect_figure, outcome_name
from tissue.study.figures.examples import frames
from tissue.study.read import Results
from tissue.study.store import COPY

if TYPE_CHECKING:
    from tissue.frames.frame import Frame
    from tissue.study.planned import PlannedComparisons

MAKES_NO_NUMBERS = True

# In place of the value of a key that the file of a scenario does not have, such as one of a type.
NOT_SET = "not set"

NAME = "page.html"
# Of a movie: pictures at most, pixels, the quality of WebP from 0 to 100, milliseconds of each and of the last picture.
PICTURES, PIXELS, QUALITY, EACH, LAST = 25, 480, 40, 140, 1500
MOST_MOVIES = 12
OF_ALL = ("positions", "ratios", "at_end")
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; line-height: 1.25; } h2 { margin-top: 2.5rem; border-bottom: 1px solid #ccc; }
section.answer { border: 1px solid #d5d5d5; border-radius: 6px; padding: 0 1rem 0.5rem; margin: 1rem 0; }
table { border-collapse: collapse; display: block; overflow-x: auto; margin: 1rem 0; font-size: 0.9rem; }
th, td { padding: 0.2rem 0.7rem; border-bottom: 1px solid #e5e5e5; text-align: left; white-space: nowrap; }
img { max-width: 100%; } pre { overflow-x: auto; background: #f6f6f6; padding: 0.7rem; font-size: 0.8rem; }
.runs { display: flex; flex-wrap: wrap; gap: 1rem; } .runs figure { flex: 1 1 20rem; margin: 0; }
.movie { width: 100%; background-size: contain; background-repeat: no-repeat; }
.note { color: #555; font-size: 0.9rem; }
"""


def write_page(results: Results, path: Path | None = None) -> Path:
    """Write the page of a study, complete or not; it has all of its pictures and movies inside.

    Parameters
    ----------
    results
        Of the study; nothing of it may be stored yet.
    path
        Where to; None: page.html in its folder.

    Raises
    ------
    InvalidProblem
        If a file of the study is damaged.
    """
    file = results.folder / NAME if path is None else path
    plan, ratios = plan_of(results), scenario_ratios(results)
    answers, reason = answers_or_reason(results)
    rows = answers.to_dict("records")
    planned = results.study.compare
    shown = (results.study.scenarios if planned is None else planned.scenarios)[:MOST_MOVIES]
    movies = {name: movie for name in shown if (movie := _movie(results, name)) is not None}
    parts = [_head(results), "<h2>Answers</h2>"]
    if plan is not None:
        parts += [f"<p class=note>{escape(reason or correction_text(results, plan))}.</p>"]
        parts += [_answer(results, plan, row, movies) for row in rows]
    elif len(ratios):
        differences = scenario_differences(ratios, results.study.replicates)
        note = "All pairs of scenarios, p corrected for all of them (Holm). [compare] in the study file plans fewer."
        parts += [f"<p class=note>{note}</p>", _table(_rounded(differences))]
    if planned is None:
        parts += ["<h2>One run of each</h2>", _runs(movies, list(movies))]
    parts += ["<h2>All scenarios at the end</h2>", _table(_rounded(ratios)), _table(_rounded(control_shares(results)))]
    parts += list(_figures(results))
    parts += ["<h2>Parameters</h2>", *_parameters(results), "<h2>Where the numbers are from</h2>", _origin(results)]
    write_text(file, _whole(results.study.title, parts, movies))
    return file


def _head(results: Results) -> str:
    study, stored = results.study, results.summary()
    runs, failed = int(stored["runs"].sum()), int(stored["failed"].sum())
    there = "all" if results.complete else f"{runs}"
    text = f"{study.replicates} runs of each of {len(study.scenarios)} scenarios, seed {study.seed}; {there} are stored"
    return f"<h1>{escape(study.title)}</h1><p>{text}, {failed} failed.</p>"


def _answer(results: Results, plan: PlannedComparisons, row: Mapping[Any, Any], movies: Mapping[str, Any]) -> str:
    """Return one answer: sentence, picture, and a run of each group."""
    weights = plan.contrasts[row["question"]]
    what = f"{outcome_name(row['outcome'])}{', ratio' if row['measure'] == 'ratio' else ''}"
    p = "" if pd.isna(row["p"]) else f", p = {row['p']:.2g}"
    needed = "" if pd.isna(row["needed"]) else f" About {row['needed']} runs of each would show an effect of this size."
    text = f"<strong>{escape(what)}: {escape(row['answer'])}</strong>, {escape(effect_text(row))}{p}.{needed}"
    picture = _image(effect_figure(results, row, weights), row["question"]) if row["runs"] else ""
    here = [name for name in weights if name in movies] if row["measure"] == "difference" else []
    return (
        f"<section class=answer><h3>{escape(row['question'])}</h3><p>{text}</p>{picture}{_runs(movies, here)}</section>"
    )


def _runs(movies: Mapping[str, tuple[str, float, str]], names: Iterable[str]) -> str:
    """Return the movies of some scenarios side by side; their bytes stand once in the style of the page."""
    figures = [
        f'<figure><div class="movie movie{list(movies).index(name)}" role=img aria-label="{escape(name)}"></div>'
        f"<figcaption>{escape(name)}, {escape(movies[name][2])}</figcaption></figure>"
        for name in names
    ]
    return f"<div class=runs>{''.join(figures)}</div>" if figures else ""


def _movie(results: Results, scenario: str) -> tuple[str, float, str] | None:
    """Return a movie of the first sound run in base64, its ratio of sides, and which run it is; None without runs."""
    stored = set(results.summary().query("runs > failed")["scenario"])
    if scenario not in stored:
        return None
    runs, parameters = results.runs(scenario, ["replicate", "seed", "status"]), results.parameters(scenario)
    first = runs[runs["status"] == "SUCCESS"].iloc[0]
    states: list[Frame]
    if parameters.in_space:  # made again it would take minutes
        if int(first["replicate"]) not in results.study.trajectories:
            return None
        table = results.trajectory(scenario, int(first["replicate"]))
        states = frames(table, sorted(table["time_h"].unique()), parameters)
    else:
        dt = parameters.numerics.dt.value
        keep = max(1, round(parameters.t_end / dt / (PICTURES - 1))) * dt
        often = parameters.changed({"numerics.keep": f"{keep:.12g} h"})
        states = measurable(simulate(often, int(first["seed"]), throw=False).frames)
    chosen = [states[k] for k in np.unique(np.linspace(0, len(states) - 1, PICTURES).round().astype(int))]
    shown, ratio = small_movie(stills(chosen, parameters), PIXELS, (EACH, LAST), QUALITY)
    return b64encode(shown).decode(), ratio, f"replicate {first['replicate']}"


def _figures(results: Results) -> Iterable[str]:
    """Give the pictures of all scenarios together."""
    for one in drawables(results):
        if one.name in OF_ALL:
            try:
                yield f"<h3>{escape(one.caption.capitalize())}</h3>{_image(one.draw(), one.caption)}"
            except InvalidProblem as error:
                yield f"<p class=note>{escape(str(error))}</p>"


def _parameters(results: Results) -> Iterable[str]:
    """Give what differs between the scenarios, then all parameters of each, folded."""
    yield _table(scenario_changes(results).replace("nan", NOT_SET))
    for name in results.study.scenarios:
        text = escape(results.parameters(name).as_toml())
        yield f"<details><summary>All parameters of {escape(name)}</summary><pre>{text}</pre></details>"


def _origin(results: Results) -> str:
    """Return the file of the study, the command that makes it again, the versions and the processors."""
    origin = results.origin
    copy = results.folder / COPY
    # A link could lead to any file of the user, and pages are sent to others.
    text = read_bytes(copy).decode() if copy.is_file() and not copy.is_symlink() else ""
    rows = "".join(f"<tr><td>{escape(name)}</td><td>{escape(str(value))}</td></tr>" for name, value in origin.items())
    file = f"<details open><summary>The file of the study</summary><pre>{escape(text)}</pre></details>" if text else ""
    command = "<code>tissue study study.toml --out results/study</code>"
    again = f"<p>Save this file as study.toml; {command} makes all runs again.</p>"
    return f"{file}{again if text else ''}<table>{rows}</table>"


def _rounded(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with numbers of four digits."""
    return table.map(lambda value: f"{value:.4g}" if isinstance(value, float) else value)


def _table(table: pd.DataFrame) -> str:
    return str(table.to_html(index=False, border=0, na_rep="")) if len(table) else ""


def _image(figure: Figure, text: str) -> str:
    with style():
        data = b64encode(png(figure)).decode()
    return f'<img alt="{escape(text)}" src="data:image/png;base64,{data}">'


def _whole(title: str, parts: Iterable[str], movies: Mapping[str, tuple[str, float, str]]) -> str:
    rules = "".join(
        f".movie{k} {{ aspect-ratio: {ratio:.4f}; background-image: url(data:image/webp;base64,{data}); }}\n"
        for k, (data, ratio, _) in enumerate(movies.values())
    )
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(title)}</title>'
    head, body = f"<head>{head}<style>{STYLE}{rules}</style></head>", "\n".join(parts)
    return f'<!DOCTYPE html>\n<html lang="en">{head}\n<body>{body}</body></html>\n'
