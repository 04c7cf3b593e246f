"""What a reader does with the pages of the site, in a real browser at two widths."""

from __future__ import annotations

import pytest

from tests.browser import HEIGHT, WIDTHS, draw_all, fits, visit
from verification.instruments.cheapest import UNDECIDED, costs, rank
from verification.instruments.interactive import DECADES
from verification.methods.chart import work_precision
from verification.site.cells import VERDICTS

PAGES = ("docs/index", *(f"docs/results/{name}" for name in ("speed", "tissue", "claims/index", "claims/chapter2")))
IN_SIGHT = "e => { const box = e.getBoundingClientRect(); return box.bottom > 0 && box.top < innerHeight; }"


# The live chart: what a reader chooses, what the page lists, and what the instrument says of the same choice.
ROWS = """() => [...document.querySelectorAll(".live tbody tr")]
    .map(row => [Number(row.dataset.target), row.dataset.word, row.dataset.tied, Number(row.dataset.cost)])"""
# As a reader would, but in one step: a page of many families is asked often.
CHOOSE = """([scene, norm, cost, without]) => {
    const root = document.getElementById("live");
    for (const [name, value] of Object.entries({scene, norm, cost})) root.querySelector(`[name=${name}]`).value = value;
    for (const box of root.querySelectorAll("input")) box.checked = !without.includes(box.value);
    root.querySelector("select").dispatchEvent(new Event("change", {bubbles: true}));
}"""


def choose(page, scene, error, cost, without=()):
    """Choose scene, error and cost, and untick families."""
    page.evaluate(CHOOSE, [scene, error, cost, list(without)])


def listed(page):
    """Return target, word ("" for one method), methods and cost of each row of the page.

    Costs have six digits. Methods are sorted: the order of methods of one cost has no meaning.
    """
    return [(target, word, _ordered(tied), _rounded(cost)) for target, word, tied, cost in page.evaluate(ROWS)]


def cheapest(one, error, cost, without=()):
    """Return what the instrument says, as ``listed``."""
    kept = [label for label, look in one.looks.items() if look["family"] not in without]
    found = costs(one.table, DECADES, error, cost)
    limit = one.budget.certain() if cost == one.budget.column else float("inf")
    return [
        (row.target, row.cheapest if row.cheapest in UNDECIDED else "", _ordered(row.tied), _rounded(row.cost))
        for row in rank(found[found["method"].isin(kept)], limit).itertuples()
    ]


def _ordered(methods):
    return sorted(methods.split("; "))


def _rounded(cost):
    return float(f"{0.0 if cost != cost else cost:.6g}")


class PagesInABrowser:
    """Tests of a site; the module that has them in a class of its own makes the fixture ``made``: folder, context."""

    @pytest.mark.parametrize("name", PAGES)
    def test_page_fits_at_both_widths_with_all_open(self, made, browser, name):
        with visit(browser, made[0] / f"{name}.html") as page:
            draw_all(page)
            page.evaluate("for (const folded of document.querySelectorAll('details')) folded.open = true")
            for width in WIDTHS:
                page.set_viewport_size({"width": width, "height": HEIGHT})
                fits(page)

    def test_search_finds_results_tutorials_and_claims(self, made, browser):
        for words, found in (
            ("midpoint", "speed"),
            ("Write your own scheme", "own_scheme"),
            ("c2.order-four", "chapter2"),
        ):
            with visit(browser, f"{(made[0] / 'search.html').as_uri()}?q={words}") as page:
                page.locator(f"#search-results a[href*='{found}']").first.wait_for()

    def test_claims_are_searched_filtered_and_opened(self, made, browser):
        claims = made[1].tables["claims"]
        with visit(browser, made[0] / "docs" / "results" / "claims" / "index.html") as page:
            seen, count = page.locator(".register tbody tr:not([hidden])"), page.locator(".register output")
            assert count.inner_text() == f"{len(claims)} of {len(claims)}"
            page.locator(".register input").fill(f"{claims['id'][3]} {claims['statement'][3].split()[0].upper()}")
            assert seen.locator("td:first-child").all_inner_texts() == [claims["id"][3]]
            page.locator(".register input").fill("")
            for verdict in VERDICTS:
                page.select_option(".register [name=verdict]", verdict)
                assert seen.count() == (claims["verdict"] == verdict).sum()
            page.select_option(".register [name=verdict]", "")
            name = claims["id"].iloc[-1]
            page.locator(".register a").get_by_text(name, exact=True).click()
            page.locator(f"[id='{name}'][open]").wait_for()
            assert page.locator(f"[id='{name}'] dd").first.evaluate(IN_SIGHT)

    def test_chart_names_the_cheapest_methods_that_the_instrument_names_and_sections_lead_to_their_scenes(
        self, made, browser
    ):
        charts = work_precision.charts(made[1].tables["work_precision"])
        with visit(browser, made[0] / "docs/results/speed.html", min(WIDTHS)) as page:
            draw_all(page)
            for scene, one in charts.items():
                for error in work_precision.ERRORS:
                    for cost in work_precision.COSTS:
                        choose(page, scene, error, cost)
                        assert listed(page) == cheapest(one, error, cost), (scene, error, cost)
            page.locator("a[href='#scene=stack']").click()
            page.wait_for_function("document.querySelector('[name=scene]').value === 'stack'")
            page.wait_for_function(f"({IN_SIGHT})(document.querySelector('[name=scene]'))")
