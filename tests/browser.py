"""A real browser for pages that people read: Debian's Chromium, by Playwright."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.optional import lacking, need_module

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

WIDTHS = (1400, 400)  # a desk and a telephone
HEIGHT = 900
PATIENCE = 60_000  # ms, for what is waited for: a machine may be slow
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
ARGUMENTS += ["--disable-sync", "--no-first-run", "--disable-dev-shm-usage"]
MISSING = "no Chromium on this machine; on Debian and Ubuntu: apt install chromium"
ORIGIN, ABORTED = r"\w+://[^/]*", "net::ERR_ABORTED"
# Elements that reach over the right edge of the page, outside of boxes that scroll.
STICKING_OUT = """() => [...document.querySelectorAll("body *")]
    .filter(e => e.getBoundingClientRect().right > innerWidth + 1 && !e.parentElement.closest(".wide"))
    .map(e => `${e.tagName} ${e.id} ${e.className}`)"""
# Figures are loaded when they come into sight; a test wants all of them.
ALL_FIGURES = """async () => {
    const figures = [...document.images];
    for (const figure of figures) figure.loading = "eager";
    await Promise.all(figures.map(figure => figure.decode()));
}"""


@contextmanager
def launched() -> Iterator[Browser]:
    """Chromium; the test is skipped where there is none, or no Playwright."""
    path = shutil.which("chromium")
    if path is None:
        lacking(MISSING)
    need_module("playwright")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=path, args=ARGUMENTS)
        yield browser
        browser.close()


@contextmanager
def visit(browser: Browser, address: Path | str, width: int = WIDTHS[0], **options: object) -> Iterator[Page]:
    """A page, closed at the end; it must have said nothing on the console, and loaded nothing from elsewhere.

    A page of a server may ask this server, and take back what it asked.
    """
    near = ("file:", "data:", *([] if isinstance(address, Path) else [re.match(ORIGIN, address)[0]]))
    page = browser.new_page(viewport={"width": width, "height": HEIGHT}, **options)
    page.set_default_timeout(PATIENCE)
    faults: list[str] = []
    page.on("console", lambda said: faults.append(said.text) if said.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("request", lambda asked: None if asked.url.startswith(near) else faults.append(asked.url))
    page.on("requestfailed", lambda asked: None if asked.failure == ABORTED else faults.append(asked.url))
    try:
        page.goto(address.as_uri() if isinstance(address, Path) else address)
        yield page
    finally:
        page.close()
    assert not faults, faults


def fits(page: Page) -> None:
    """Nothing makes the page scroll sideways."""
    if page.evaluate("document.documentElement.scrollWidth") > page.viewport_size["width"]:
        pytest.fail(f"wider than {page.viewport_size['width']}: {page.evaluate(STICKING_OUT)}")


def draw_all(page: Page) -> None:
    """Wait until all figures and charts are drawn; raises what a figure has against being shown."""
    page.evaluate(ALL_FIGURES)
    for chart in page.locator("figure > div, .figure .live").all():
        chart.locator(".bk-Canvas").wait_for()
