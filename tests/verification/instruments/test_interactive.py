"""Charts that answer to the pointer: what is drawn, what is told, and that they need nothing from elsewhere."""

import json
import re

import numpy as np
import pandas as pd
import pytest

from verification.instruments.interactive import draw_work_precision, script

LOOKS = {"PBD": {"family": "PBD"}, "coarse": {"family": "catch-up"}, "fine": {"family": "catch-up"}}


def table(failed=()):
    """Three methods at four settings; those named fail at the finest one."""
    rows = []
    for rank, method in enumerate(LOOKS):
        for k in range(4):
            status = "NOT_CONVERGED" if method in failed and k == 3 else "SUCCESS"
            run = {"method": method, "setting": 0.1 / 2**k, "status": status, "overlap": 1e-3}
            errors = {"largest": 10.0 ** -(k + rank) if status == "SUCCESS" else np.nan, "reference_error": 1e-14}
            rows.append(run | errors | {"cpu_seconds": 1e-3 * 2**k})
    return pd.DataFrame(rows)


def drawn(html):
    """The parts of the chart, as the library has them."""
    (text,) = re.findall(r"const docs_json = '(.*?)';", html)
    found = []

    def walk(part):
        if isinstance(part, dict):
            found.append(part)
            for inner in part.values():
                walk(inner)
        elif isinstance(part, list):
            for inner in part:
                walk(inner)

    walk(json.loads(text.encode().decode("unicode_escape")))
    return found


def named(parts, name):
    return [part for part in parts if part.get("name") == name and "attributes" in part]


def sources(parts):
    entries = [dict(part["attributes"]["data"]["entries"]) for part in named(parts, "ColumnDataSource")]
    return [entry for entry in entries if "method" in entry]


@pytest.mark.parametrize("failed", [(), ("coarse",)])
def test_each_run_is_a_point_that_says_what_it_is(failed):
    rows = table(failed)
    parts = drawn(draw_work_precision(rows, LOOKS, "largest", "cpu_seconds"))
    done = rows[rows["status"] == "SUCCESS"]
    columns = ("method", "setting", "status")
    told = [point for source in sources(parts) for point in zip(*(source[name] for name in columns), strict=True)]
    assert sorted(told) == sorted(zip(*(rows[name] for name in columns), strict=True))
    (hover,) = named(parts, "HoverTool")
    assert {text for _, text in hover["attributes"]["tooltips"]} >= {"@method", "@status"}
    assert max(y for source in sources(parts) for y in source["y"]) >= done["largest"].max()


def test_a_click_on_a_family_hides_its_methods():
    parts = drawn(draw_work_precision(table(("PBD",)), LOOKS, "largest", "cpu_seconds"))
    (legend,) = named(parts, "Legend")
    assert legend["attributes"]["click_policy"] == "hide"
    shown = {
        item["attributes"]["label"]["value"]: len(item["attributes"]["renderers"])
        for item in named(parts, "LegendItem")
    }
    # A line and its points for each method; those that failed by themselves.
    assert shown == {"efficient front": 1, "PBD": 2, "catch-up": 4, "run that failed": 1}


def test_the_script_is_in_the_page():
    text = script()
    assert len(text) > 1e6
    assert "</script" not in text.lower()
    assert "src=" not in re.sub(r"\s", "", draw_work_precision(table(), LOOKS, "largest", "cpu_seconds"))
