"""A Sphinx extension: results in pages of Markdown, as Jinja calls.

``{{ table("orders", "Caption.") }}``, ``{{ figure("speed", "Caption.") }}``, ``{{ chart("speed", "Caption.") }}`` and
``{{ number("speed") }}`` show what pages of results gave by these names (``verification.site.context``). Further calls:
``card`` for the first page, ``claims(2)`` for the claims of a chapter, ``register()`` for the table of all claims,
``again("tissue_")`` for what was rerun of the studies whose names begin so, ``agreement()`` and ``facts()``.

The folder of the site has the tables and figures, and the pages link them there. Formulas, ``$x_k$``, become MathML, so
that pages need no script and no network. The modules that decide claims have pages of their code.
"""

from __future__ import annotations

import json
import linecache
import struct
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from html import escape
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from jinja2 import Environment, StrictUndefined
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from dincl.files import write_text
from verification.claims.decide import READING, readings
from verification.site.cells import VERDICTS, grid, render
from verification.site.context import SHOWN

if TYPE_CHECKING:
    from sphinx.application import Sphinx

STATIC = Path(__file__).parent / "static"
# Tables with more rows are folded.
ROWS = 12
BOKEH, CODE = "_static/bokeh.js", "code"
RERUN = {
    "title": "Study",
    "runs": "Runs made again",
    "of": "of",
    "rows": "Rows compared",
    "apart": "Do not agree",
    "worst": "Farthest",
    "pace": "Pace",
    "made": "Complete study of",
}


def setup(app: Sphinx) -> dict[str, Any]:
    """Register what the pages need; ``site_pages`` in conf.py lists how the names of pages with results begin."""
    app.add_config_value("site_pages", (), "env")
    app.config.html_static_path.append(str(STATIC))
    app.config.html_math_renderer = "mathml"
    app.add_html_math_renderer("mathml", (_inline_formula, None), (_formula, None))
    app.add_css_file("results.css")
    app.add_js_file("results.js", loading_method="defer")
    app.connect("env-get-outdated", lambda app, env, *_: [name for name in env.found_docs if _of_results(app, name)])
    app.connect("source-read", fill)
    app.connect("html-collect-pages", _code)
    app.connect("build-finished", _script)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _of_results(app: Sphinx, name: str) -> bool:
    return name.startswith(tuple(app.config.site_pages))


def fill(app: Sphinx, name: str, source: list[str]) -> None:
    """Fill in the calls of a page with results."""
    if _of_results(app, name):
        page = _Page(Path(app.outdir), name)
        calls = {one: getattr(page, one) for one in vars(_Page) if not one.startswith("_")}
        source[0] = Environment(undefined=StrictUndefined, autoescape=False).from_string(source[0]).render(calls)


class _Page:
    """The calls of one page; each returns Markdown."""

    def __init__(self, out: Path, name: str) -> None:
        self._out, self._root, self._leaf = out, "../" * name.count("/"), name.rpartition("/")[2]

    @cached_property
    def _shown(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads((self._out / "tables" / SHOWN).read_text("utf-8"))
        return found

    def table(self, name: str, caption: str, folded: bool = False) -> str:
        """Show a table under its caption; a long one opens on a click."""
        given = self._shown["grids"][name]
        file = f"{given['file']}.csv"
        there = (self._out / "tables" / file).exists()
        link = f'<a href="{self._root}tables/{file}">{file}</a>' if there else ""
        return _table(f"table-{name}", given["html"], given["rows"], caption, folded, link)

    def figure(self, name: str, caption: str) -> str:
        """Show a figure, which a click opens at full size, above its caption."""
        path = self._out / "figures" / f"{name}.png"
        width, height = struct.unpack(">II", path.read_bytes()[16:24])
        link = f"{self._root}figures/{path.name}"
        image = f'<img src="{link}" width="{width}" height="{height}" loading="lazy" alt="{escape(caption)}">'
        return _captioned(f"figure-{name}", f'<a href="{link}">{image}</a>', caption)

    def chart(self, name: str, caption: str) -> str:
        """Show a chart that answers to the reader, above its caption."""
        # The library comes first: the chart would wait for it only so long.
        html = f'<script src="{self._root}{BOKEH}"></script>\n{self._shown["charts"][name]}'
        no_script = "<noscript><p>This chart needs JavaScript; the figures below do not.</p></noscript>"
        return _captioned(f"chart-{name}-{self._leaf}", html + no_script, caption)

    def number(self, name: str) -> str:
        """Return a number as text."""
        return str(self._shown["numbers"][name])

    def card(self, name: str, page: str, title: str, sentence: str) -> str:
        """Show a finding in a grid of the first page: title, number, sentence, and a link to its page."""
        head = f"::::{{grid-item-card}} {title}\n:link: {page}\n:link-type: doc\n:class-card: finding"
        return f"{head}\n\n**{self.number(name)}** {sentence}\n::::"

    def claims(self, chapter: int) -> str:
        """Show the claims of a chapter, each with quotation, correction, evidence and code."""
        rows = [row for row in self._claims if row["chapter"] == chapter]
        return _raw(render("claims.html", rows=rows, places=self._places, root=self._root))

    def register(self, titles: Mapping[int, str]) -> str:
        """Show all claims in one table, with a field for words, and filters."""
        found = [row["effect"] for row in self._claims]
        filters = {"chapter": titles.values(), "verdict": VERDICTS, "correction": sorted({one for one in found if one})}
        given = {"rows": self._claims, "places": self._places, "titles": titles, "filters": filters}
        return _raw(render("register.html", **given))

    @cached_property
    def _claims(self) -> list[dict[str, Any]]:
        """The rows of ``verification.claims.decide.decide_all`` with their chapter, and what pages make of them."""
        table = pd.read_parquet(self._out / "tables" / "claims.parquet")
        columns = readings(table)
        lists = ("also", "rests_on", "wrong")
        return [
            row
            | {name: row[name].split(", ") if row[name] else [] for name in lists}
            | {
                "look": VERDICTS[row["verdict"]],
                "code": _place(row["check"]),
                "runs": [name for name in row["runs"].split(", ") if (self._out / "tables" / f"{name}.csv").exists()],
                # A sentence made of the comparisons says them all.
                "compared": row["printed"] not in row["measured"],
                "by_reading": _by_reading(row, columns),
            }
            for row in table.to_dict("records")
        ]

    @property
    def _places(self) -> dict[str, str]:
        """The address of each claim from pages of claims."""
        return {row["id"]: f"chapter{row['chapter']}.html#{row['id']}" for row in self._claims}

    def again(self, *beginnings: str) -> str:
        """Show what came of rerunning parts of studies; nothing before that."""
        found = [one for name, one in self._shown["agreements"].items() if name.startswith(beginnings)]
        if not found:
            return ""
        html = grid(pd.DataFrame(found)[list(RERUN)].rename(columns=RERUN))
        table = _table(f"table-again-{self._leaf}", html, len(found), "Rerun here and compared, row by row.", True)
        return f"## Made again on this machine\n\n{self._agreeing(found)}\n\n{table}"

    def agreement(self) -> str:
        """Say in a sentence what came of rerunning parts of all studies."""
        return self._agreeing(list(self._shown["agreements"].values()))

    def _agreeing(self, found: Sequence[Mapping[str, Any]]) -> str:
        if not found:
            return "Parts of the studies are being rerun on this machine; `make report` then says whether they agree."
        off = [one for one in found if one["apart"]]
        others = "; ".join(f"{one['title']}, {one['apart']} of {one['rows']} rows" for one in off)
        return (
            f"Parts of {len(found)} complete studies that ship were rerun here; {len(found) - len(off)} agree to three "
            f"digits in every row{f' (not: {others})' if off else ''}. Times are left out; the pace is the median of "
            "the times here over those of the complete study."
        )

    def facts(self) -> str:
        """List the machine, and the versions of libraries."""
        return "\n".join(f"- {name}: {value}" for name, value in self._shown["facts"])


def _captioned(name: str, html: str, caption: str) -> str:
    return f":::::{{container}} figure\n:name: {name}\n\n{_raw(html)}\n\n{caption}\n:::::"


def _raw(html: str) -> str:
    return f"``````{{raw}} html\n{html}\n``````"


def _table(name: str, html: str, rows: int, caption: str, folded: bool, link: str = "") -> str:
    body = _raw(f'<div class="wide">{html}</div>')
    if folded or rows > ROWS:
        return f":::::{{dropdown}} {caption} ({rows} rows)\n:name: {name}\n\n{body}\n\n{link}\n:::::"
    return f":::::{{container}} grid\n:name: {name}\n\n{caption} {link}\n\n{body}\n:::::"


def _by_reading(row: Mapping[str, Any], columns: Sequence[str]) -> list[tuple[str, str, str]]:
    """Return name, verdict and numbers of each reading; nothing for a claim with one reading."""
    measured = dict(line.split(": ", 1) for line in row["readings"].splitlines())
    found = [(column.removeprefix(READING), row[column]) for column in columns if row[column]]
    return [(name, verdict, measured[name]) for name, verdict in found]


def _place(check: str) -> str:
    """Return the address of a check, ``verification.thesis.chapter2.claims.s1_methods:12``, in the site."""
    module, line = check.split(":")
    _, _, chapter, _, section = module.split(".")
    return f"{CODE}/{chapter}.html#{section}-{line}"


def _code(app: Sphinx) -> Iterator[tuple[str, dict[str, Any], str]]:
    """Yield a page for each folder of modules that decide claims."""
    file = Path(app.outdir) / "tables" / "claims.parquet"
    checks = pd.read_parquet(file, columns=["check"])["check"] if file.exists() else []
    pages: dict[str, list[str]] = {}
    for module in dict.fromkeys(check.split(":")[0] for check in checks):
        text = "".join(linecache.getlines(str(import_module(module).__file__)))
        _, _, chapter, _, section = module.split(".")
        form = HtmlFormatter(linenos="inline", lineanchors=section, cssclass="highlight checks")
        pages.setdefault(chapter, []).append(f"<h2>{module}</h2>{highlight(text, PythonLexer(), form)}")
    for chapter, parts in pages.items():
        title = f"Checks of claims: {chapter}"
        yield f"{CODE}/{chapter}", {"title": title, "body": f"<h1>{title}</h1>{''.join(parts)}"}, "page.html"


def _script(app: Sphinx, failure: Exception | None) -> None:
    """Put the script of charts into the site."""
    from verification.instruments.interactive import script

    path = Path(app.outdir) / BOKEH
    if failure is None and not path.exists():
        write_text(path, script())


def _inline_formula(writer: Any, node: Any) -> None:
    writer.body.append(_mathml(node))
    raise nodes.SkipNode


def _formula(writer: Any, node: Any) -> None:
    writer.body.append(f'<div class="formula">{_mathml(node, as_block=True)}</div>')
    raise nodes.SkipNode


def _mathml(node: Any, as_block: bool = False) -> str:
    """Return the MathML of a formula; its text, and a warning, where it cannot be set."""
    from sphinx.util import logging

    try:
        return str(tex2mathml(node.astext(), as_block=as_block))
    except MathError as error:
        logging.getLogger(__name__).warning("formula %s: %s", node.astext(), error, location=node)
        return f"<code>{escape(node.astext())}</code>"
