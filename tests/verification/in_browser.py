"""What a reader does with the pages of a report, in a real browser at two widths."""

from __future__ import annotations

import functools
import struct
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

import pytest

from tests.browser import HEIGHT, WIDTHS, draw_all, fits, visit
from tests.verification.live import cheapest, choose, listed
from tests.verification.page import Page
from verification.methods.chart import work_precision
from verification.methods.chart.references import SCENES
from verification.site.parts import VERDICTS
from verification.thesis.chapters import CHAPTERS

if TYPE_CHECKING:
    from playwright.sync_api import Page as BrowserPage

PAGES = ("index.html", *(chapter.file for chapter in CHAPTERS))
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


def leads_somewhere(link: str) -> None:
    """A link to a file that is there, and to a place in it, if it names one."""
    parts = urlsplit(link)
    file = Path(unquote(parts.path))
    assert parts.scheme == "file", link
    assert file.is_file(), link
    assert not parts.fragment or unquote(parts.fragment) in places(file), link


@functools.cache
def places(file: Path) -> set[str]:
    """The places of a page that a link can name."""
    return set(Page(file.read_text("utf-8")).ids)


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
    labels = page.locator(".bk-tooltip-row-label").all_inner_texts()
    assert {"setting:", "error:", "status:"} <= set(labels)


class PagesInABrowser:
    """Tests of a report; the module that has them in a class of its own makes the fixture ``made``."""

    @pytest.mark.parametrize("name", PAGES)
    def test_page_fits_shows_all_and_leads_somewhere(self, made, browser, name):
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        with visit(browser, made[0].parent / name) as page:
            draw_all(page)
            for width in WIDTHS:
                page.set_viewport_size({"width": width, "height": HEIGHT})
                fits(page)
                page.screenshot(path=SCREENSHOTS / f"{Path(name).stem}-{width}.jpg", full_page=True, quality=80)
            page.evaluate("for (const folded of document.querySelectorAll('details')) folded.open = true")
            for width in reversed(WIDTHS):
                page.set_viewport_size({"width": width, "height": HEIGHT})
                fits(page)
            assert page.evaluate("document.getAnimations().length") == 0
            for link in page.evaluate("[...document.links].map(link => link.href)"):
                leads_somewhere(link)

    def test_first_page_leads_to_what_was_found(self, made, browser):
        with visit(browser, made[0]) as page:
            page.locator(".findings a").last.click()
            assert page.locator(":target").evaluate(IN_SIGHT)
            page.locator("nav a").first.click()
            assert page.url == made[0].as_uri()

    def test_contents_stay_in_sight(self, made, browser):
        with visit(browser, made[0].parent / "tissue.html", DESK) as page:
            page.evaluate("scrollTo(0, document.body.scrollHeight)")
            assert page.locator("nav [aria-current]").evaluate(IN_SIGHT)
            page.locator("nav li li a").first.click()
            assert page.locator("h2").first.evaluate(IN_SIGHT)

    def test_contents_fold_on_a_telephone(self, made, browser):
        with visit(browser, made[0].parent / "tissue.html", TELEPHONE) as page:
            page.evaluate("scrollTo(0, document.body.scrollHeight)")
            contents = page.locator("nav summary")
            assert contents.evaluate(IN_SIGHT)
            assert not page.locator("nav ol").first.is_visible()
            contents.click()
            page.locator("nav li li a").nth(1).click()
            assert not page.locator("nav ol").first.is_visible()
            top = page.locator("h2").nth(1).bounding_box()["y"]
            assert contents.bounding_box()["y"] < top < HEIGHT / 2

    def test_statements_are_searched_filtered_and_opened(self, made, browser):
        claims = made[1].tables["claims"]
        with visit(browser, made[0].parent / "statements.html") as page:
            seen, all_of_them = page.locator(".claim:not([hidden])"), f"{len(claims)} of {len(claims)}"
            assert page.inner_text("#matches") == all_of_them
            page.keyboard.press("/")
            page.keyboard.type(f"{claims['id'][3]} {claims['statement'][3].split()[0].upper()}")
            assert seen.evaluate_all("es => es.map(e => e.id)") == [claims["id"][3]]
            page.keyboard.press("Escape")
            assert page.inner_text("#matches") == all_of_them
            assert page.evaluate("document.activeElement.id") != "words"
            assert page.locator(".verdicts dt").all_inner_texts() == list(VERDICTS)
            for verdict in VERDICTS:
                page.select_option("#verdict", verdict)
                assert seen.count() == (claims["verdict"] == verdict).sum()
            page.select_option("#verdict", "holds")
            page.click("#unfold")
            assert page.locator(".claim[open]").count() == (claims["verdict"] == "holds").sum()
            page.click("#unfold")
            assert page.locator(".claim[open]").count() == 0

    def test_link_to_a_statement_opens_it(self, made, browser):
        name = made[1].tables["claims"]["id"].iloc[-1]
        with visit(browser, f"{(made[0].parent / 'statements.html').as_uri()}#{name}") as page:
            assert page.locator(f"[id='{name}']").get_attribute("open") == ""
            assert page.locator(f"[id='{name}'] p").first.evaluate(IN_SIGHT)
            page.locator("details:has(td a) > summary").first.click()
            page.locator("td a:visible").first.click()
            assert page.locator(":target.claim[open] p").first.evaluate(IN_SIGHT)

    def test_chart_is_a_picture_where_scripts_do_not_run(self, made, browser):
        with visit(browser, made[0].parent / "speed.html", java_script_enabled=False) as page:
            assert page.locator("figure img").count() >= len(SCENES)
            assert page.locator("noscript").first.is_visible()
        with visit(browser, made[0].parent / "meanfield.html", java_script_enabled=False) as page:
            assert page.locator("noscript img").first.is_visible()

    def test_folded_table_opens_by_a_click_a_link_and_on_paper(self, made, browser):
        with visit(browser, made[0].parent / "tissue.html") as page:
            folded = page.locator("main details").first
            table = folded.locator("table")
            folded.locator("summary").click()
            assert table.is_visible()
            folded.locator("summary").click()
            assert not table.is_visible()
            page.evaluate(
                "addEventListener('afterprint', () => window.open_on_paper = seen, {once: true});"
                "addEventListener('beforeprint', () => "
                "window.seen = document.querySelectorAll('main details[open]').length, {once: true})"
            )
            page.pdf()
            assert page.evaluate("open_on_paper") == page.locator("main details").count()
            assert not table.is_visible()
            place = table.get_attribute("id")
            page.goto(f"{page.url}#{place}")
            assert table.is_visible()

    def test_figure_opens_at_full_size(self, made, browser):
        with visit(browser, made[0].parent / "experiments.html", TELEPHONE) as page:
            figure = page.locator("figure a:has(img)").first
            figure.scroll_into_view_if_needed()
            figure.click()
            width = page.locator("img").evaluate("e => e.naturalWidth")
            drawn = Path(unquote(urlsplit(page.url).path)).read_bytes()
            assert (width,) == struct.unpack(">I", drawn[16:20])

    def test_chart_tells_what_is_under_the_pointer(self, made, browser):
        with visit(browser, made[0].parent / "speed.html") as page:
            draw_all(page)
            chart = page.locator("figure > div").first
            for width in WIDTHS:
                page.set_viewport_size({"width": width, "height": HEIGHT})
                chart.evaluate("e => e.scrollIntoView()")  # its top, where it is longer than the window
                tells(page, width)

    def test_chart_names_the_cheapest_methods_that_the_instrument_names(self, made, browser):
        charts = work_precision.charts(made[1].tables["work_precision"])
        with visit(browser, made[0].parent / "speed.html") as page:
            draw_all(page)
            for scene, one in charts.items():
                for error in work_precision.ERRORS:
                    for cost in work_precision.COSTS:
                        choose(page, scene, error, cost)
                        assert listed(page) == cheapest(one, error, cost), (scene, error, cost)
                choose(page, scene, "largest", "cpu_seconds", ["event-driven"])
                assert listed(page) == cheapest(one, "largest", "cpu_seconds", ["event-driven"]), scene

    def test_chart_shows_the_scene_of_a_section(self, made, browser):
        with visit(browser, made[0].parent / "speed.html", TELEPHONE) as page:
            draw_all(page)
            page.locator("a[href='#scene=stack']").click()
            page.wait_for_function("document.querySelector('[name=scene]').value === 'stack'")
            assert page.locator("[name=scene]").evaluate(IN_SIGHT)
            page.locator(".live input").first.uncheck()
            assert page.url.endswith("#scene=stack&norm=largest&cost=cpu_seconds&without=PBD")

    def test_finger_on_a_chart_moves_the_page(self, made, browser):
        with visit(browser, made[0].parent / "speed.html", TELEPHONE, has_touch=True, is_mobile=True) as page:
            draw_all(page)
            page.locator("figure > div").first.scroll_into_view_if_needed()
            x, y, _ = page.evaluate(FIRST_RUN)
            before, finger = page.evaluate("scrollY"), page.context.new_cdp_session(page)
            for kind, way in (("touchStart", 0), ("touchMove", 40), ("touchMove", 80), ("touchMove", 120)):
                finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y - way}]})
            finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
            page.wait_for_function(f"scrollY > {before}")

    @pytest.mark.parametrize("name", ["tissue.html", "statements.html"])
    def test_keys_reach_all_that_answers(self, made, browser, name):
        with visit(browser, made[0].parent / name, TELEPHONE) as page:
            wanted = page.evaluate(
                "[...document.querySelectorAll('summary, a[href], input, select, button')]"
                ".filter(e => e.checkVisibility()).map(e => e.outerHTML)"
            )
            reached = []
            for _ in wanted:
                page.keyboard.press("Tab")
                reached.append(page.evaluate("document.activeElement.outerHTML"))
            assert reached == wanted
            page.locator("main details summary").first.focus()
            page.keyboard.press("Enter")
            assert page.locator("main details").first.get_attribute("open") == ""
            page.locator("nav summary").focus()
            page.keyboard.press("Enter")
            page.keyboard.press("Tab")
            assert page.locator("nav a").first.evaluate("e => e === document.activeElement")
