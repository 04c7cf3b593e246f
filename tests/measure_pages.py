"""How soon the pages of a report are seen, and how they look: ``python -m tests.measure_pages [FOLDER]``.

For each page its size, and the milliseconds to the first contentful paint, median and largest of ``TIMES`` visits by a
browser that has seen nothing before. Screenshots at both widths are put into FOLDER/screenshots. No test: these are
times, and depend on what else the machine does.
"""

import sys
from pathlib import Path
from statistics import median

from playwright.sync_api import Browser

from tests.browser import WIDTHS, draw_all, launched, visit

TIMES = 5
PAINT = """() => new Promise(seen => new PerformanceObserver(found => {
    for (const entry of found.getEntries()) if (entry.name === "first-contentful-paint") seen(entry.startTime);
}).observe({type: "paint", buffered: true}))"""


def first_paint(browser: Browser, file: Path) -> float:
    """Milliseconds from the call for a page until something of it is seen."""
    with visit(browser, file) as page:
        return page.evaluate(PAINT)


def screenshots(browser: Browser, file: Path) -> None:
    """The whole page at each width."""
    for width in WIDTHS:
        with visit(browser, file, width) as page:
            draw_all(page)
            page.screenshot(path=file.parent / "screenshots" / f"{file.stem}-{width}.png", full_page=True)


if __name__ == "__main__":
    folder = Path(*sys.argv[1:] or ["report"]).resolve()
    print(f"{'page':20} {'kB':>6} {'first paint [ms]':>17} {'largest':>8}")
    with launched() as browser:
        for file in sorted(folder.glob("*.html")):
            times = [first_paint(browser, file) for _ in range(TIMES)]
            print(f"{file.name:20} {file.stat().st_size / 1e3:6.0f} {median(times):17.0f} {max(times):8.0f}")
            screenshots(browser, file)
    print(f"Screenshots are in {folder / 'screenshots'}.")
