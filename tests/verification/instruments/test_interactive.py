"""The chart that answers to the reader: what is drawn, which method is the cheapest, and the address of a choice."""

import numpy as np
import pandas as pd
import pytest

from tests.browser import draw_all, launched, visit
from tests.verification.live import cheapest, choose, listed
from verification.instruments.budget import CpuSeconds
from verification.instruments.chart import WorkPrecision
from verification.instruments.cheapest import UNDECIDED
from verification.instruments.interactive import draw_chart, script

pytestmark = pytest.mark.slow
ERRORS, COSTS = ("largest", "final", "overlap"), ("cpu_seconds", "drift_evaluations")
LOOKS = {name: {"family": name.split()[0]} for name in ("first A", "first B", "second", "outside", "absent")}
BUDGET = CpuSeconds(0.03)
PAGE = "<!DOCTYPE html><title>A chart</title><body><figure>{}</figure><script>{}</script></body>"
# The lines as they are drawn, the names at their ends, and the crosses.
DRAWN = """() => {
    const chart = Bokeh.documents[0].roots()[0], of = kind => chart.renderers.filter(r => r.glyph.type === kind);
    const points = of("Scatter").map(r => r.data_source.data), names = of("Text")[0].data_source.data;
    return {points: points.slice(0, -1).map(data => [...data.y].length), failed: [...points.at(-1).y].length,
            names: [...names.text], heights: [...names.y].map(Math.log10),
            dots: chart.inner_height / Math.log10(chart.y_range.end / chart.y_range.start)};
}"""


def table(seed):
    """Runs of five methods, with errors that fall, stagnate or rise, zeros, missing numbers, failures and near ties."""
    random, rows = np.random.default_rng(seed), []
    for method in LOOKS:
        errors = 10.0 ** np.cumsum(random.uniform(-1.6, 0.3, 9))
        for k, error in enumerate(errors):
            status = "SUCCESS" if method != "absent" and random.random() < 0.95 else "OUT_OF_BUDGET"
            run = {"method": method, "setting": 0.1 / 2**k, "status": status, "reference_error": 1e-7 * seed}
            run |= {"largest": error, "final": error * random.choice([0.0, 0.5, np.nan], p=[0.1, 0.8, 0.1])}
            run |= {"overlap": random.choice([0.0, error]), "drift_evaluations": float(2**k)}
            run |= {"cpu_seconds": 1e-3 * 2**k * random.choice([1.0, 1.2, 3.0]), "spread": random.choice([1.0, 1.4])}
            rows.append(run)
    return pd.DataFrame(rows)


CHARTS = {f"scene_{k}": WorkPrecision(table(k), ERRORS, BUDGET, LOOKS, title=f"Scene {k}") for k in range(6)}


@pytest.fixture(scope="module")
def browser():
    with launched() as found:
        yield found


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("chart") / "chart.html"
    html = draw_chart(CHARTS, COSTS, {"first A": "A"})
    path.write_text(PAGE.format(html, script()), "utf-8")
    return path


@pytest.fixture(scope="module")
def page(browser, page_file):
    with visit(browser, page_file) as found:
        draw_all(found)
        yield found


@pytest.mark.parametrize("without", [(), ("second",), ("first", "outside")])
@pytest.mark.parametrize("cost", COSTS)
@pytest.mark.parametrize("error", ERRORS)
def test_the_page_and_the_instrument_name_the_same_methods(page, error, cost, without):
    for name, one in CHARTS.items():
        choose(page, name, error, cost, without)
        assert listed(page) == cheapest(one, error, cost, without)


def test_the_tables_of_these_tests_have_all_cases():
    rows = [row for one in CHARTS.values() for error in ERRORS for row in cheapest(one, error, "cpu_seconds")]
    assert {word for _, word, _, _ in rows} == {"", *UNDECIDED}
    assert len({tied[0] for _, word, tied, _ in rows if not word}) > 2


def test_without_methods_nothing_is_reached(page):
    choose(page, "scene_0", "largest", "cpu_seconds", {look["family"] for look in LOOKS.values()})
    assert {word for _, word, _, _ in listed(page)} == {"not reached"}
    assert page.evaluate(DRAWN)["names"] == []


def test_every_run_is_drawn_and_lines_are_named_at_their_ends(page):
    choose(page, "scene_2", "largest", "cpu_seconds")
    rows, drawn = CHARTS["scene_2"].table, page.evaluate(DRAWN)
    done = rows[rows["status"] == "SUCCESS"].groupby("method").size()
    assert drawn["points"] == [done.get(method, 0) for method in LOOKS]
    assert drawn["failed"] == (rows["status"] != "SUCCESS").sum()
    assert sorted(drawn["names"]) == sorted({"A", *LOOKS} - {"first A", "absent"})
    gaps = np.abs(np.diff(sorted(drawn["heights"])))
    assert (gaps * drawn["dots"] > 12).all()
    assert page.inner_text(".absent") == "Without a line here: absent (too slow)."


def test_an_address_restores_the_choice_it_was_made_of(browser, page_file):
    with visit(browser, page_file) as first:
        draw_all(first)
        choose(first, "scene_3", "final", "drift_evaluations", ("second", "outside"))
        link, shown = first.url, listed(first)
    assert link.endswith("#scene=scene_3&norm=final&cost=drift_evaluations&without=second,outside")
    with visit(browser, link) as second:
        draw_all(second)
        assert listed(second) == shown
        left = second.locator(".live input:not(:checked)").evaluate_all("boxes => boxes.map(box => box.value)")
        assert left == ["second", "outside"]
        second.evaluate("location.hash = '#scene=scene_1'")
        second.wait_for_function("document.querySelector('[name=norm]').value === 'largest'")
        assert listed(second) == cheapest(CHARTS["scene_1"], "largest", "cpu_seconds")
