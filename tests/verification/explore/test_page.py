"""The page in a real browser: every kind of control, wrong values, the picture, comparing, and the exported study."""

import re

import pytest

import tissue
from tests.browser import launched, visit
from tests.verification.explore.site import (
    change,
    enter,
    field,
    interval,
    numbers,
    run_of,
    served,
    wait_for_run,
    wait_for_runs,
    write_base,
)
from tests.verification.explore.small import SMALL
from tissue.pictures.charts import OUTCOMES
from tissue.study.plan import run_seeds
from tissue.study.run import run_study
from verification.explore.sequences import bounded
from verification.explore.tissues.setting import Setting

pytestmark = pytest.mark.slow

RUNS = 400
QUIET = 0.3  # seconds in which a process without work uses no tick
BEGIN = Setting("thesis", tissue.preset("thesis")).with_values(SMALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    write_base(folder, BEGIN)
    return folder


@pytest.fixture(scope="module")
def site(folder):
    with served(folder, "small.toml") as (address, process):
        yield address, process


@pytest.fixture(scope="module")
def page(browser_of_all, site):
    """One visitor for most tests: loading a page takes longest."""
    with visit(browser_of_all, site[0]) as found:
        wait_for_runs(found, RUNS)  # the server has answered: what is done before it hears is lost
        for group in ("Basal layer", "Numerics"):
            found.get_by_text(group, exact=True).click()
        yield found


@pytest.fixture(scope="module")
def browser_of_all():
    with launched() as opened:
        yield opened


def knob(page, key):
    return page.locator(f'[data-key="{key}"]')


def undo(page, key):
    """Set a knob as it was, and wait for the picture."""
    before = run_of(page)
    knob(page, key).get_by_label(f"{key} as it was").click()
    wait_for_run(page, before)


def test_it_shows_a_tissue_and_an_answer_with_intervals(page):
    wait_for_runs(page, RUNS, "A")
    found = numbers(page)
    value, low, high = interval(found[OUTCOMES["apical"][2]][0])
    assert 0 <= low < value < high <= 100
    assert interval(found["height [µm]"][0])[0] > 0
    player = page.locator(".player")
    assert player.get_attribute("data-status") == "SUCCESS"
    assert int(player.get_attribute("data-cells")) >= 12


@pytest.mark.parametrize(
    ("key", "text"), [("numerics.mu", "0.2 h"), ("emt.a", "2 h, 50 %"), ("tissue.two_daughters", "0.9")]
)
def test_a_field_changes_the_picture_and_is_marked(page, key, text):
    change(page, key, text)
    assert "changed" in knob(page, key).get_attribute("class")
    undo(page, key)
    assert "changed" not in knob(page, key).get_attribute("class")


def test_a_slider_changes_its_field(page):
    before = run_of(page)
    slider = knob(page, "tissue.cells").locator(".q-slider")
    slider.click(position={"x": 90, "y": 10})
    wait_for_run(page, before)
    assert int(field(page, "tissue.cells").input_value()) > 12
    undo(page, "tissue.cells")


def test_a_choice_and_a_switch_change_the_layer(page):
    before = run_of(page)
    page.get_by_role("combobox", name="choose layer.shape").click()
    page.get_by_role("option", name="circle").click()
    wait_for_run(page, before)
    assert "changed" in knob(page, "layer.shape").get_attribute("class")
    undo(page, "layer.shape")


@pytest.mark.parametrize(
    ("key", "text", "said"),
    [
        ("tissue.cells", "-3", "must be a whole number from 1 to 1000000"),
        ("numerics.mu", "0.2", "the unit is missing"),
        ("numerics.t_end", "3.05 h", "must be a whole number of steps dt"),
    ],
)
def test_what_is_impossible_is_said_beside_the_field_and_changes_nothing(page, key, text, said):
    before = run_of(page)
    enter(page, key, text)
    knob(page, key).get_by_text(said).wait_for()
    assert field(page, key).input_value() == text
    assert run_of(page) == before
    knob(page, key).get_by_label(f"{key} as it was").click()
    knob(page, key).get_by_text(said).wait_for(state="detached")


def test_the_picture_plays_pauses_steps_and_is_scrubbed(page):
    player = page.locator(".player")
    page.wait_for_function("document.querySelector('.player').dataset.state == 'ready'")
    page.wait_for_function("document.querySelector('.player').dataset.playing == 'false'")
    assert float(player.get_attribute("data-time")) == 4.0
    page.get_by_label("time", exact=True).fill("2")
    assert float(player.get_attribute("data-time")) == 2.0
    player.get_by_label("step forward").click()
    assert 2.0 < float(player.get_attribute("data-time")) < 2.2
    player.get_by_label("step back").click()
    assert float(player.get_attribute("data-time")) == 2.0
    player.get_by_label("speed").select_option("4")
    player.get_by_label("play", exact=True).click()
    page.wait_for_function("Number(document.querySelector('.player').dataset.time) > 3")


def test_a_cell_is_followed_by_a_click_and_colours_have_a_legend(page):
    for colouring in ("type", "yab", "phase"):
        page.get_by_label("colour by").select_option(colouring)
        page.wait_for_function(
            "name => document.querySelector('.legend').innerText.includes(name)",
            arg={"type": "control", "yab": "y_AB", "phase": "mitosis"}[colouring],
        )
    box = page.locator(".player canvas").bounding_box()
    for k in range(40):
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] * (k + 1) / 41)
        page.wait_for_timeout(0)
        if page.locator(".player .said").inner_text().startswith("cell"):
            break
    assert page.locator(".player").get_attribute("data-followed") is not None


def test_two_settings_are_compared_and_the_exported_study_has_the_numbers_of_the_page(page, folder):
    wait_for_runs(page, RUNS)
    page.get_by_role("button", name="Compare: hold this").click()
    change(page, "emt.s", "1 h")
    wait_for_runs(page, RUNS, "B")
    shown = numbers(page)
    page.get_by_role("button", name="Make this a study").click()
    page.get_by_label("name of the file").fill("mine.toml")
    page.get_by_role("button", name="Write the file").click()
    page.get_by_text("tissue study mine.toml --out results/mine").wait_for()
    page.get_by_role("button", name="Close").click()
    results = run_study(folder / "mine.toml", folder / "results" / "mine")
    text = (folder / "mine.toml").read_text("utf-8")
    assert (
        f"# Written on the page to explore after a look at {RUNS} runs of A and {RUNS} runs of B, with seed = " in text
    )
    seed = int(text.partition("with seed = ")[2].partition(".")[0])
    for scenario in "AB":
        assert set(run_seeds(seed, scenario, range(RUNS))).isdisjoint(results.runs(scenario)["seed"])
    # The same file with the seed of the page.
    again = folder / "again.toml"
    again.write_text(re.sub(r"(?m)^seed = .*", f"seed = {seed}", text), "utf-8")
    results = run_study(again, folder / "results" / "again")
    for what, (_, _, name) in OUTCOMES.items():
        for scenario, text in zip("BA", shown[name][:2], strict=True):
            values = results.values(scenario, what).to_numpy()
            known = [100 * one for one in (values.mean(), *bounded(values))]
            assert interval(text) == pytest.approx(known, abs=0.0501)
        assert shown[name][2].endswith(f" points, {RUNS} runs of each")
        assert shown[name][3]


def test_parameters_are_saved_and_opened_and_copied(page, folder):
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_label("name of the file").fill("kept")
    page.locator(".dialog").get_by_role("button", name="Save").click()
    page.get_by_text("kept.toml is saved").wait_for()
    page.locator(".dialog").get_by_role("button", name="Save").click()
    page.get_by_text("must be a new name").wait_for()
    page.get_by_role("button", name="Close").click()
    before = run_of(page)
    page.get_by_role("combobox", name="begin with").click()
    page.get_by_role("option", name="kept.toml").click()
    wait_for_run(page, before)
    assert tissue.load(folder / "kept.toml").emt.cells == 3


def test_visitors_do_not_disturb_each_other_and_a_setting_outlives_a_reload(browser_of_all, site, page):
    with visit(browser_of_all, site[0]) as one:
        wait_for_runs(one, RUNS)
        wait_for_runs(page, RUNS)
        before = numbers(page)
        change(one, "emt.cells", "1")
        wait_for_runs(one, RUNS)
        known = numbers(one)
        assert known != before
        assert numbers(page) == before
        one.reload()
        wait_for_runs(one, RUNS)
        assert (numbers(one), field(one, "emt.cells").input_value()) == (known, "1")
