"""How soon ``tissue explore`` answers, and how fast it goes on: ``python -m tests.measure_explore``.

Of the page as it begins (60 cells that become 112 in 48 h, ten of them EMT cells), after a warm-up: milliseconds from
the step of a slider to the first picture of another run, and to the first numbers with intervals, median and largest of
``TIMES``; pictures a second while it plays and no ensemble grows; runs a second of the ensemble of the page, and of
``tissue study`` of the same setting, in turns. No test: these are times, and depend on what else the machine does.
"""

import tempfile
import time
from pathlib import Path
from statistics import median

from playwright.sync_api import Page

import tissue
from tests.browser import launched
from tests.verification.explore.site import change, served
from tissue.study.run import run_study
from verification.explore.command import BEGIN
from verification.explore.tissues.dialogs import study_text
from verification.explore.tissues.setting import Setting

TIMES = 20
RUNS = 400
# Milliseconds from a key on the slider until the page shows another run, and until it has the numbers of its ensemble.
STEP = """key => new Promise(seen => {
    const player = document.querySelector(".player"), told = document.querySelector("[data-is=runs]");
    const slider = document.querySelector(`[data-key="${key}"] .q-slider [tabindex]`);
    const began = performance.now(), run = player.dataset.run;
    let picture = null, old = true;
    const look = () => {
        if (picture === null && player.dataset.run !== run) picture = performance.now() - began;
        if (told.dataset.runs === "0") old = false;
        if (picture !== null && !old && told.dataset.runs !== "0") seen([picture, performance.now() - began]);
        else requestAnimationFrame(look);
    };
    slider.dispatchEvent(new KeyboardEvent("keydown", {keyCode: 37, key: "ArrowLeft", bubbles: true}));
    look();
})"""
ENOUGH = "n => Number(document.querySelector('[data-is=runs]')?.dataset.runs) >= n"


def answers(page: Page) -> None:
    """Time from the step of a slider to the picture, and to the interval."""
    page.get_by_text("Numerics", exact=True).click()
    page.locator('[data-key="numerics.mu"] .q-slider').wait_for()
    found = []
    for _ in range(TIMES + 1):
        found.append(page.evaluate(STEP, "numerics.mu"))
        page.wait_for_timeout(300)
    for name, times in zip(("picture", "interval"), zip(*found[1:], strict=True), strict=True):
        print(f"slider to first {name}: median {median(times):.0f} ms, largest {max(times):.0f} ms of {TIMES}")


def pictures(page: Page) -> None:
    """Pictures a second, when nothing else is done."""
    page.wait_for_function(ENOUGH, arg=RUNS)
    page.get_by_label("time", exact=True).fill("38")
    page.get_by_label("speed").select_option("0.5")
    page.get_by_label("play", exact=True).click()
    page.wait_for_timeout(4000)
    player = page.locator(".player")
    print(f"{player.get_attribute('data-cells')} cells: {player.get_attribute('data-fps')} pictures a second")
    page.get_by_label("pause", exact=True).click()


def speed(page: Page, folder: Path, turns: int = 3) -> None:
    """Runs a second on the page and of a study, in turns."""
    setting = Setting("thesis", tissue.preset("thesis")).with_values(BEGIN)
    (folder / "study.toml").write_text(study_text("study", {"A": setting}, RUNS, 0))
    ratios = []
    for turn in range(turns):
        change(page, "numerics.mu", f"0.15{turn + 1} h")
        began = time.perf_counter()
        page.wait_for_function(ENOUGH, arg=RUNS)
        here = RUNS / (time.perf_counter() - began)
        began = time.perf_counter()
        run_study(folder / "study.toml", folder / f"results{turn}")
        there = RUNS / (time.perf_counter() - began)
        ratios.append(here / there)
        print(f"{here:.0f} runs a second on the page, {there:.0f} of tissue study: ratio {here / there:.2f}")
    print(f"median ratio {median(ratios):.2f}")


def hundred(page: Page) -> None:
    """Seconds to 100 runs after a change."""
    change(page, "numerics.mu", "0.16 h")
    began = time.perf_counter()
    page.wait_for_function(ENOUGH, arg=100)
    print(f"100 runs after {time.perf_counter() - began:.2f} s")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name, served(Path(name)) as (address, _), launched() as browser:
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.goto(address)
        page.wait_for_function(ENOUGH, arg=RUNS)
        answers(page)
        pictures(page)
        hundred(page)
        speed(page, Path(name))
