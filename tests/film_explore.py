"""The film of ``tissue explore`` in the docs: ``python -m tests.film_explore docs/explore.webp``.

A visitor looks at the tissue, turns a knob, sees the picture and the answer change, and compares.
"""

import io
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page

from tests.browser import launched
from tests.verification.explore.site import change, served

SIZE = {"width": 1400, "height": 860}
WIDTH, QUALITY = 900, 55  # of the film [pixels], of WebP
EVERY = 200  # ms between two pictures


def seen(page: Page, pictures: int) -> Iterator[Image.Image]:
    """What the page shows, one picture after the other."""
    for _ in range(pictures):
        image = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
        yield image.resize((WIDTH, round(WIDTH * image.height / image.width)), Image.Resampling.LANCZOS)
        page.wait_for_timeout(EVERY / 2)


def story(page: Page) -> Iterator[Image.Image]:
    """The scenes, one behind the other."""
    page.get_by_label("speed").select_option("2")
    yield from seen(page, 25)
    page.get_by_role("button", name="Compare: hold this").click()
    yield from seen(page, 4)
    slider = page.locator('[data-key="emt.inm"] .q-slider [tabindex]')
    slider.focus()
    for _ in range(10):
        for _ in range(10):
            page.keyboard.press("ArrowLeft")
        yield from seen(page, 1)
    yield from seen(page, 15)
    change(page, "emt.p", "6 h to 24 h")
    page.get_by_label("time", exact=True).fill("6")
    page.get_by_label("play", exact=True).or_(page.get_by_label("pause", exact=True)).click()
    yield from seen(page, 25)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name, served(Path(name)) as (address, _), launched() as browser:
        visitor = browser.new_page(viewport=SIZE)
        visitor.goto(address)
        visitor.wait_for_selector(".numbers td")
        first, *rest = story(visitor)
        first.save(sys.argv[1], save_all=True, append_images=rest, duration=EVERY, loop=0, quality=QUALITY, method=6)
