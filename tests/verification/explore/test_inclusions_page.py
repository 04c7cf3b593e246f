"""The tab of inclusions in a browser: problem, method, dt and end time are chosen, and what goes wrong is seen."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.browser import WIDTHS, fits, visit

pytestmark = pytest.mark.slow

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

ROOT = Path(__file__).parents[3]
FALLS = """
import numpy as np
import dincl
problem = dincl.Problem([[0.3, 1.0]], lambda t, x: np.array([[0.0, -1.0]]) - x, [dincl.HalfSpace((0, 1))])
"""
CLOSES = """
import dincl
walls = dincl.HalfSpace((0, 1), -0.5, 0.5), dincl.HalfSpace((0, -1), lambda t: t - 1.5, 0.5)
problem = dincl.Problem([[0.0, 0.0], [0.0, 1.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5), *walls])
t = [0.5]
"""
SLIDER = ".inclusions .q-slider__track-container"
RUN = "document.querySelector('.player').dataset"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """It has a file that names a problem, one whose runs fail, and one that names none."""
    made = tmp_path_factory.mktemp("folder")
    (made / "falls.py").write_text(FALLS, "utf-8")
    (made / "closes.py").write_text(CLOSES, "utf-8")
    (made / "wrong.py").write_text("problem = 3", "utf-8")
    return made


@pytest.fixture(scope="module")
def site(folder: Path) -> Iterator[str]:
    """The address of a server of this folder."""
    command = [sys.executable, "-m", "tests.verification.explore.inclusions_site", str(folder)]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
        yield server.stdout.readline().strip()
        server.stdin.close()
        assert server.wait(60) == 0


def choose(page: "Page", label: str, option: str) -> None:
    page.get_by_role("combobox", name=label, exact=True).locator("xpath=ancestor::label").click()
    page.get_by_role("option", name=option, exact=True).click()


def says(page: "Page", place: str, text: str) -> None:
    page.locator(f"[data-is='{place}']", has_text=text).wait_for()


class TestTab:
    def test_choices_show_in_the_picture(self, browser: "Browser", site: str) -> None:
        with visit(browser, site) as page, visit(browser, site) as other:
            says(page, "reference", "event-driven, estimated error")
            page.wait_for_function(f"{RUN}.state === 'ready' && {RUN}.status === 'SUCCESS' && {RUN}.cells === '10'")
            page.locator(SLIDER).press("ArrowLeft")
            says(page, "dt", "dt = 3/128 = 0.0234")
            page.wait_for_function(f"{RUN}.run > 1 && {RUN}.state === 'ready'")
            choose(page, "method", "penalty 100")
            choose(page, "problem", "A disc slides over a fixed disc")
            says(page, "reference", "the exact solution")
            page.wait_for_function(f"{RUN}.cells === '1' && {RUN}.state === 'ready'")
            says(other, "dt", "dt = 3/64 = 0.0469")

    def test_wrong_values_are_said_and_change_nothing(self, browser: "Browser", site: str, folder: Path) -> None:
        with visit(browser, site) as page:
            says(page, "dt", "dt = 3/64 =")
            choose(page, "problem", "wrong.py")
            says(page, "problem-fault", "wrong.py: problem = 3: must be a dincl.Problem")
            end = page.get_by_role("spinbutton", name="end time")
            for wrong, message in (("-1", "must be a finite number > 0"), ("", "None"), ("31", "must be at most 30")):
                end.fill(wrong)
                end.press("Enter")
                says(page, "end-fault", message)
            says(page, "dt", "dt = 3/64 =")
            choose(page, "problem", "falls.py")
            says(page, "about", "Problem(N = 1, d = 2, constraints = [HalfSpace])")
            page.locator("[data-is='end-fault']", has_text="must").wait_for(state="detached")
            end.fill("2")
            end.press("Enter")
            says(page, "dt", "dt = 2/64 =")
            (folder / "falls.py").write_text(f"{FALLS}t = [0.5]", "utf-8")
            page.get_by_role("button", name="Read again").click()
            says(page, "dt", "dt = 0.5/64 =")

    def test_on_a_telephone_a_run_that_fails_says_so(self, browser: "Browser", site: str) -> None:
        with visit(browser, site, min(WIDTHS)) as page:
            says(page, "dt", "dt = 3/64 = 0.0469")
            choose(page, "problem", "closes.py")
            choose(page, "method", "catch-up")
            page.wait_for_function(f"{RUN}.status === 'NOT_CONVERGED'")
            fits(page)
