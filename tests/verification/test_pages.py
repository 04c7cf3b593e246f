"""What pages of results are made of: cells, tables, and the calls of the extension; without any study."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from jinja2 import UndefinedError

from tests.executors import Nowhere
from verification.claims import Verdict
from verification.site import cells
from verification.site.cells import cell, formula, grid, number, percents
from verification.site.context import SHOWN, Context
from verification.site.extension import fill


def test_what_is_empty_is_not_printed() -> None:
    rows = pd.DataFrame({"a": [1.0, np.nan], "none": [np.nan, np.nan], "x_k": ["<b>", ""], "blank": ["", ""]})
    assert grid(rows) == (
        '<table class="sortable"><thead><tr><th>a</th><th>x<sub>k</sub></th></tr></thead>'
        '<tbody><tr><td class="number">1</td><td>&lt;b&gt;</td></tr></tbody></table>'
    )


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("x_{k+1} = P_S(x_k)", "x<sub>k+1</sub> = P<sub>S</sub>(x<sub>k</sub>)"),
        ("e^{2M_F}, R^soft, 10^(-3)", "e<sup>2M<sub>F</sub></sup>, R<sup>soft</sup>, 10<sup>-3</sup>"),
        ("(Bx_{k+1} - g)", "(Bx<sub>k+1</sub> - g)"),
        ("λ_max(D²W) ≥ 0", "λ<sub>max</sub>(D²W) ≥ 0"),
        ("cpu_seconds of emt_ratios.csv", "cpu_seconds of emt_ratios.csv"),
        ("a < b & c", "a &lt; b &amp; c"),
    ],
)
def test_scripts_are_set_and_names_of_code_stay(text: str, html: str) -> None:
    assert formula(text) == html


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.1234, "0.123"),
        (12.0, "12"),
        (1234.4, "1234"),
        (1.5e-7, "1.5·10⁻⁷"),
        (1e-3, "10⁻³"),
        (-2e5, "-2.0·10⁵"),
        (np.nan, "—"),
    ],
)
def test_numbers(value: float, text: str) -> None:
    assert number(value) == text
    assert cell(value) == (text, "number")


def test_cells() -> None:
    assert cell(True) == ("yes", "")
    assert cell(np.False_) == ("no", "")
    assert cell(3) == ("3", "number")
    assert cell("refuted, holds when corrected") == ("refuted, holds when corrected", "corrected")
    assert cell("PBD") == ("PBD", "")
    assert cells.VERDICTS.keys() == {verdict.value for verdict in Verdict}
    assert percents((0.25, 0.204, 0.3)) == "25 % [20, 30]"
    assert percents((0.0123, -0.0002, 0.03), 1, "+") == "+1.2 % [+0.0, +3.0]"


def filled(out: Path, text: str, name: str = "docs/results/some") -> str:
    """A page with its calls filled in."""
    app, source = SimpleNamespace(outdir=out, config=SimpleNamespace(site_pages=("docs/results/",))), [text]
    fill(app, name, source)  # type: ignore[arg-type]
    return source[0]


def test_pages_show_what_was_given(tmp_path: Path) -> None:
    context = Context(tmp_path, True, Nowhere())
    context.keep("few", pd.DataFrame({"a": [1, 2]}))
    assert pd.read_csv(tmp_path / "tables" / "few.csv")["a"].tolist() == [1, 2]
    context.show("short", context.tables["few"], "few")
    context.show("long", pd.DataFrame({"a": range(13)}))
    context.numbers["best"] = "42 %"
    context.publish([("Processor", "one")])
    assert json.loads((tmp_path / "tables" / SHOWN).read_text("utf-8"))["grids"]["long"]["rows"] == 13
    short = filled(tmp_path, '{{ table("short", "Two rows.") }}')
    assert "{container}" in short
    assert "Two rows." in short
    assert "../../tables/few.csv" in short
    assert "{dropdown} Many. (13 rows)" in filled(tmp_path, '{{ table("long", "Many.") }}')
    assert filled(tmp_path, '{{ number("best") }} {{ again("x_") }}{{ facts() }}') == "42 % - Processor: one"
    assert filled(tmp_path, "{{ other }}", "docs/other") == "{{ other }}"
    with pytest.raises(UndefinedError, match="tabel"):
        filled(tmp_path, '{{ tabel("short") }}')
