"""What a reader does with the pages of the site, in a real browser at two widths."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.browser import HEIGHT, WIDTHS, draw_all, fits, visit
from tests.verification.live import cheapest, choose, listed
from verification.methods.chart import work_precision
from verification.site.cells import VERDICTS

if TYPE_CHECKING:
    from playwright.sync_api import Page as BrowserPage

RESULTS = [
    "speed",
    "orders",
    "failures",
    "geometry",
    "tissue",
    "emt",
    "curved",
    "space",
    "needs",
    "meanfield",
    "claims/index",
    "claims/chapter2",
]
PAGES = ("docs/index", "docs/explain/which_method", *(f"docs/results/{name}" for name in RESULTS))
DESK, TELEPHONE = WIDTHS
# Kept after the tests, to be looked at; git ignores the folder.
SCREENSHOTS = Path(__file__).parents[2] / "build" / "screenshots"
IN_SIGHT = "e => { const box = e.getBoundingClientRect(); return box.bottom > 0 && box.top < innerHeight; }"
# Where the first run of the first chart is on the screen, and its method.
FIRST_RUN = """() => {
    const chart = Bokeh.documents[0].roots()[0], view = Bokeh.index.get_by_id(chart.id);
    const runs = chart.renderers.find(r => r.glyph.type === "Scatter" && r.data_source.data.x.length).data_source.data;
    const canvas = view.canvas_view.el.getBoundingClientRect(), {x_scale, y_scale} = view.frame_view;
    return [canvas.x + x_scale.compute(runs.x[0]), canvas.y + y_scale.compute(runs.y[0]), runs.method[0]];
}"""


def tells(page: BrowserPage, width: int) -> None:
    """What is under the pointer on the first run of the first chart is told, inside of the window."""
    page.mouse.move(0, 0)
    page.locator(".bk-tooltip-row-value").first.wait_for(state="detached")
    x, y, method = page.evaluate(FIRST_RUN)
    page.mouse.move(x, y)
    told = page.locator(".bk-tooltip-row-value").get_by_text(method, exact=True).first
    told.wait_for()
    box = told.bounding_box()
    assert 0 <= box["x"] < box["x"] + box["width"] <= width


class PagesInABrowser:
    """Tests of a site; the module that has them in a class of its own makes the fixture ``made``: folder, context."""

    @pytest.mark.parametrize("name", PAGES)
    @pytest.mark.parametrize("scheme", ["light", "dark"])
    def test_page_fits_at_both_widths_with_all_open(self, made, browser, name, scheme):
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        with visit(browser, made[0] / f"{name}.html", color_scheme=scheme) as page:
            draw_all(page)
            for width in WIDTHS:
                page.set_viewport_size({"width": width, "height": HEIGHT})
                fits(page)
                file = f"{name.replace('/', '-')}-{width}-{scheme}.jpg"
                page.screenshot(path=SCREENSHOTS / file, full_page=True, quality=80)
            page.evaluate("for (const folded of document.querySelectorAll('details')) folded.open = true")
            for width in reversed(WIDTHS):
                page.set_viewport_size({"width": width, "height": HEIGHT})
                fits(page)

    def test_first_screen_has_the_cards(self, made, browser):
        with visit(browser, made[0] / "docs" / "index.html") as page:
            assert page.locator(".finding img").evaluate_all(f"es => es.map({IN_SIGHT})") == 6 * [True]
            page.locator(".finding").first.click()
            assert page.url.endswith("results/speed.html")

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
            assert page.locator(f"[id='{name}']").get_attribute("open") == ""
            assert page.locator(f"[id='{name}'] dd").first.evaluate(IN_SIGHT)

    def test_table_is_sorted_by_a_column(self, made, browser):
        with visit(browser, made[0] / "docs" / "results" / "orders.html") as page:
            head = page.locator("#table-references th").last
            cells = page.locator("#table-references td:last-child")
            before = sorted(cells.all_inner_texts())
            for _ in range(2):
                head.click()
            assert sorted(cells.all_inner_texts()) == before
            assert head.get_attribute("data-sorted") == "down"

    def test_folded_table_opens_by_a_link_and_on_paper(self, made, browser):
        with visit(browser, f"{(made[0] / 'docs/results/tissue.html').as_uri()}#table-tissue-accuracy") as page:
            assert page.locator("#table-tissue-accuracy table").is_visible()
            page.evaluate(
                "addEventListener('afterprint', () => window.open_on_paper = seen, {once: true});"
                "addEventListener('beforeprint', () => "
                "window.seen = document.querySelectorAll('article details[open]').length, {once: true})"
            )
            page.pdf()
            assert page.evaluate("open_on_paper") == page.locator("article details").count()
            assert page.locator("article details[open]").count() == 1

    def test_chart_is_a_picture_where_scripts_do_not_run(self, made, browser):
        for name in ("speed", "meanfield"):
            with visit(browser, made[0] / f"docs/results/{name}.html", java_script_enabled=False) as page:
                assert page.locator("noscript").first.is_visible()
                assert page.locator(".figure img").count() > 1

    def test_chart_tells_what_is_under_the_pointer(self, made, browser):
        with visit(browser, made[0] / "docs/results/speed.html") as page:
            draw_all(page)
            for width in WIDTHS:
                page.set_viewport_size({"width": width, "height": HEIGHT})
                page.locator(".live").evaluate("e => e.scrollIntoView({behavior: 'instant'})")
                tells(page, width)

    def test_chart_names_the_cheapest_methods_that_the_instrument_names(self, made, browser):
        charts = work_precision.charts(made[1].tables["work_precision"])
        with visit(browser, made[0] / "docs/results/speed.html") as page:
            draw_all(page)
            for scene, one in charts.items():
                for error in work_precision.ERRORS:
                    for cost in work_precision.COSTS:
                        choose(page, scene, error, cost)
                        assert listed(page) == cheapest(one, error, cost), (scene, error, cost)
                choose(page, scene, "largest", "cpu_seconds", ["event-driven"])
                assert listed(page) == cheapest(one, "largest", "cpu_seconds", ["event-driven"]), scene

    def test_chart_shows_the_scene_of_a_section(self, made, browser):
        with visit(browser, made[0] / "docs/results/speed.html", TELEPHONE) as page:
            draw_all(page)
            page.locator("a[href='#scene=stack']").click()
            page.wait_for_function("document.querySelector('[name=scene]').value === 'stack'")
            page.wait_for_function(f"({IN_SIGHT})(document.querySelector('[name=scene]'))")
            page.locator(".live input").first.uncheck()
            assert page.url.endswith("#scene=stack&norm=largest&cost=cpu_seconds&without=PBD")

    def test_finger_on_a_chart_moves_the_page(self, made, browser):
        with visit(browser, made[0] / "docs/results/speed.html", TELEPHONE, has_touch=True, is_mobile=True) as page:
            draw_all(page)
            page.locator(".live").scroll_into_view_if_needed()
            x, y, _ = page.evaluate(FIRST_RUN)
            page.evaluate("y => scrollBy({top: y - 450, behavior: 'instant'})", y)
            x, y, _ = page.evaluate(FIRST_RUN)
            before, finger = page.evaluate("scrollY"), page.context.new_cdp_session(page)
            for kind, way in (("touchStart", 0), ("touchMove", 40), ("touchMove", 80), ("touchMove", 120)):
                finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y - way}]})
            finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
            page.wait_for_function(f"scrollY > {before}")
