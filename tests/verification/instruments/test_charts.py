"""Charts name all that is drawn on them; the live one says what the instrument says, and has an address."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest

import dincl
import verification as v
from tests.browser import draw_all, launched, visit
from tests.verification.in_browser import cheapest, choose, listed
from verification.instruments import charts
from verification.instruments.cheapest import UNDECIDED
from verification.instruments.interactive import draw_chart, script

SLIDE = dincl.scenes.sliding_disc()
T = [1.0, 2.0]


class Slow(dincl.Stepper):
    def step(self, t, h, state):
        return dincl.StepState(state.x + h * self.velocity(t, state.x))


@dataclass(frozen=True)
class Euler(dincl.FixedStep):
    def stepper(self, problem):
        return Slow(problem)


def exact(problem, dt, t):
    return SLIDE.exact(t)


def missing(problem, dt, t):
    import no_such_library  # noqa: F401


METHODS = [
    v.Method("PBD", scheme=dincl.PBD),
    v.Method("Euler", scheme=Euler),
    v.Method("Ipopt", scheme=lambda dt: dincl.CatchUp(dt, dincl.Ipopt(tol=1e-9))),
    v.Method("fast", run=exact, compiled=True),
    v.Method("fails", run=lambda problem, dt, t: np.nan * problem.drift(0.0, problem.x0) * np.ones((len(t), 1, 1))),
    v.Method("absent", run=missing),
    v.Method("refuses", scheme=lambda tol: dincl.PBD(1e-15), setting="tol"),
    v.Method("slow", scheme=lambda dt: dincl.PBD(dt * 1e-4)),
]


def entries(axes):
    handles, labels = axes.get_legend_handles_labels()
    return dict(zip(labels, handles, strict=True))


def test_every_method_has_an_entry_that_says_what_its_steps_are_or_why_it_has_no_run():
    settings = {"dt": [0.1, 0.01, 0.001], "tol": [1e-3]}
    axes = v.work_precision(SLIDE, METHODS, settings, T, SLIDE.exact, v.DriftEvaluations(10**4)).plot(
        cost="drift_evaluations"
    )
    found = entries(axes)
    assert {"PBD (compiled)", "Euler (calls Python)", "Ipopt (calls Python)", "fast: not counted"} <= set(found)
    assert {"fails: failed", "absent: left out", "slow: too slow", "refuses: refused"} <= set(found)
    assert found[charts.FAILED].get_marker() == "x"
    alone = v.work_precision(SLIDE, [METHODS[0], METHODS[3]], [0.1], T, SLIDE.exact, v.CpuSeconds(1.0))
    assert {"PBD (compiled)", "fast (compiled)"} <= set(entries(alone.plot()))
    assert charts.FAILED not in entries(alone.plot())


# The live chart

ERRORS, COSTS = ("largest", "final", "overlap"), ("cpu_seconds", "drift_evaluations")
LOOKS = {name: {"family": name.split()[0]} for name in ("first A", "first B", "second", "outside", "absent")}
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


CHARTS = {f"scene_{k}": v.WorkPrecision(table(k), ERRORS, v.CpuSeconds(0.03), LOOKS, f"Scene {k}") for k in range(6)}


@pytest.fixture(scope="module")
def opened():
    with launched() as found:
        yield found


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("chart") / "chart.html"
    path.write_text(PAGE.format(draw_chart(CHARTS, COSTS, {"first A": "A"}), script()), "utf-8")
    return path


@pytest.fixture(scope="module")
def page(opened, page_file):
    with visit(opened, page_file) as found:
        draw_all(found)
        yield found


@pytest.mark.slow
@pytest.mark.parametrize("without", [(), ("second",), ("first", "outside")])
def test_the_page_and_the_instrument_name_the_same_methods(page, without):
    words, methods = set(), set()
    for cost in COSTS:
        for error in ERRORS:
            for name, one in CHARTS.items():
                choose(page, name, error, cost, without)
                found = listed(page)
                assert found == cheapest(one, error, cost, without)
                words |= {word for _, word, _, _ in found}
                methods |= {tied[0] for _, word, tied, _ in found if not word}
    assert words == {"", *UNDECIDED} or without
    assert len(methods) > 2 or without
    choose(page, "scene_0", "largest", "cpu_seconds", {look["family"] for look in LOOKS.values()})
    assert {word for _, word, _, _ in listed(page)} == {"not reached"}


@pytest.mark.slow
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


@pytest.mark.slow
def test_an_address_restores_the_choice_it_was_made_of(opened, page_file):
    with visit(opened, page_file) as first:
        draw_all(first)
        choose(first, "scene_3", "final", "drift_evaluations", ("second", "outside"))
        link, shown = first.url, listed(first)
    assert link.endswith("#scene=scene_3&norm=final&cost=drift_evaluations&without=second,outside")
    with visit(opened, link) as second:
        draw_all(second)
        assert listed(second) == shown
        left = second.locator(".live input:not(:checked)").evaluate_all("boxes => boxes.map(box => box.value)")
        assert left == ["second", "outside"]
        second.evaluate("location.hash = '#scene=scene_1'")
        second.wait_for_function("document.querySelector('[name=norm]').value === 'largest'")
        assert listed(second) == cheapest(CHARTS["scene_1"], "largest", "cpu_seconds")
