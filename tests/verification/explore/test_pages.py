"""The page in a real browser: every kind of control, wrong values, pictures, comparing, and the exported study."""

import re
from contextlib import contextmanager

import pytest

import tissue
from tests.browser import PATIENCE, WIDTHS, fits, launched, visit
from tests.tissue.space.in_space import of_surface
from tests.verification.explore.site import served
from tests.verification.explore.test_tissues import SMALL, THESIS
from tissue.frames.section import section
from tissue.pictures.charts import OUTCOMES
from tissue.study.plan import run_seeds
from tissue.study.run import run_study
from verification.explore.dialogs import parameters_text
from verification.explore.frames import finely_kept
from verification.explore.sequences import bounded
from verification.explore.session import SEED
from verification.explore.setting import Setting

pytestmark = pytest.mark.slow

RUNS = 400
# What the player says of its pictures.
SHOWN = "document.querySelector('.player')?.dataset"
NUMBERS = "[...document.querySelectorAll('.numbers tbody tr')].map(r => [...r.cells].map(c => c.innerText))"
COUNTED = """([runs, name]) => {
    const told = document.querySelector('[data-is=runs]');
    return told?.dataset.runs == runs && told.innerText.startsWith(name) && !told.innerText.includes('...');
}"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    write_base(folder, THESIS.with_values(SMALL))
    return folder


@pytest.fixture(scope="module")
def site(folder):
    with served(folder, "small.toml") as (address, _):
        yield address


@pytest.fixture(scope="module")
def opened():
    with launched() as browser:
        yield browser


@pytest.fixture(scope="module")
def page(opened, site):
    """One visitor for most tests: loading a page takes longest."""
    with visit(opened, site) as found:
        wait_for_runs(found)  # the server has answered: what is done before it hears is lost
        for group in ("Basal layer", "Numerics"):
            found.get_by_text(group, exact=True).click()
        yield found


def write_base(folder, setting):
    """A parameter file that a page begins with."""
    (folder / "small.toml").write_text(parameters_text(setting))


def numbers(page):
    """The table of the answer: texts by name."""
    return {first: rest for first, *rest in page.evaluate(NUMBERS) if rest}


def wait_for_runs(page, name=""):
    """Until all runs are in the answer; they give way to whatever else the machine does."""
    page.wait_for_function(COUNTED, arg=[RUNS, name], timeout=5 * PATIENCE)


def interval(text):
    """The numbers in a text such as "14.4 % [10.0, 20.3]"."""
    return [float(number) for number in re.findall(r"-?[0-9.]+", text)]


def knob(page, key):
    return page.locator(f'[data-key="{key}"]')


def field(page, key):
    """The text field of a knob."""
    return page.get_by_label(key, exact=True).and_(page.locator("input"))


def enter(page, key, text):
    """Type into the field of a knob, and leave it."""
    field(page, key).fill(text)
    field(page, key).press("Enter")
    field(page, key).blur()


@contextmanager
def another_run(page):
    """Do what changes the setting, and wait until its picture is there."""
    before = int(page.locator(".player").get_attribute("data-run"))
    yield
    page.wait_for_function(f"before => Number({SHOWN}?.run) > before", arg=before)


def change(page, key, text):
    with another_run(page):
        enter(page, key, text)
    page.locator(f'[data-key="{key}"].changed').wait_for()


def undo(page, key):
    with another_run(page):
        knob(page, key).get_by_label(f"{key} as it was").click()
    page.locator(f'[data-key="{key}"]:not(.changed)').wait_for()


def test_it_shows_a_tissue_and_an_answer_with_intervals(page):
    wait_for_runs(page, "A")
    found = numbers(page)
    value, low, high = interval(found[OUTCOMES["apical"][2]][0])
    assert 0 <= low < value < high <= 100
    assert interval(found["height [µm]"][0])[0] > 0
    assert page.locator(".player").get_attribute("data-status") == "SUCCESS"
    assert int(page.locator(".player").get_attribute("data-cells")) >= 12


def test_fields_sliders_and_choices_change_the_picture_and_are_marked(page):
    for key, text in (("numerics.mu", "0.2 h"), ("emt.a", "2 h, 50 %"), ("tissue.two_daughters", "0.9")):
        change(page, key, text)
        undo(page, key)
    with another_run(page):
        knob(page, "tissue.cells").locator(".q-slider").click(position={"x": 90, "y": 10})
    assert int(field(page, "tissue.cells").input_value()) > 12
    undo(page, "tissue.cells")
    with another_run(page):
        page.get_by_role("combobox", name="choose layer.shape").click()
        page.get_by_role("option", name="circle").click()
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
    before = page.locator(".player").get_attribute("data-run")
    enter(page, key, text)
    knob(page, key).get_by_text(said).wait_for()
    assert field(page, key).input_value() == text
    assert page.locator(".player").get_attribute("data-run") == before
    knob(page, key).get_by_label(f"{key} as it was").click()
    knob(page, key).get_by_text(said).wait_for(state="detached")


def test_the_picture_plays_pauses_steps_and_cells_are_followed(page):
    player = page.locator(".player")
    page.wait_for_function(f"{SHOWN}?.state == 'ready' && {SHOWN}.playing == 'false'")
    assert float(player.get_attribute("data-time")) == 4.0
    page.get_by_label("time", exact=True).first.fill("2")
    assert float(player.get_attribute("data-time")) == 2.0
    player.get_by_label("step forward").click()
    assert 2.0 < float(player.get_attribute("data-time")) < 2.2
    player.get_by_label("step back").click()
    assert float(player.get_attribute("data-time")) == 2.0
    player.get_by_label("speed").select_option("4")
    player.get_by_label("play", exact=True).click()
    page.wait_for_function(f"Number({SHOWN}.time) > 3")
    for colouring, name in (("type", "control"), ("yab", "y_AB"), ("phase", "mitosis")):
        player.get_by_label("colour by").select_option(colouring)
        player.locator(".legend", has_text=name).wait_for()
    box = player.locator("canvas").bounding_box()
    for k in range(40):
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] * (k + 1) / 41)
        page.wait_for_timeout(0)
        if player.locator(".said").inner_text().startswith("cell"):
            break
    assert player.get_attribute("data-followed") is not None


def test_two_settings_are_compared_and_the_exported_study_has_the_numbers_of_the_page(page, folder):
    wait_for_runs(page)
    with another_run(page):
        page.get_by_role("button", name="Compare: hold this").click()
    change(page, "emt.s", "1 h")
    wait_for_runs(page, "B")
    shown = numbers(page)
    page.get_by_role("button", name="Make this a study").click()
    page.get_by_label("name of the file").fill("mine.toml")
    page.get_by_role("button", name="Write the file").click()
    page.get_by_text("tissue study mine.toml --out results/mine").wait_for()
    page.get_by_role("button", name="Close").click()
    text = (folder / "mine.toml").read_text("utf-8")
    assert f"after a look at {RUNS} runs of A and {RUNS} runs of B, with seed = " in text
    seed = int(text.partition("with seed = ")[2].partition(".")[0])
    assert f"\nseed = {seed}\n" not in text
    # The same file with the seed of the page.
    (folder / "again.toml").write_text(re.sub(r"(?m)^seed = .*", f"seed = {seed}", text), "utf-8")
    results = run_study(folder / "again.toml", folder / "results" / "again")
    for what, (_, _, name) in OUTCOMES.items():
        for scenario, text in zip("BA", shown[name][:2], strict=True):
            values = results.values(scenario, what).to_numpy()
            known = [100 * one for one in (values.mean(), *bounded(values))]
            assert interval(text) == pytest.approx(known, abs=0.0501)
        assert shown[name][2].endswith(f" points, {RUNS} runs of each")
        assert shown[name][3]


def test_parameters_are_saved_and_opened(page, folder):
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_label("name of the file").fill("kept")
    page.locator(".dialog").get_by_role("button", name="Save").click()
    page.get_by_text("kept.toml is saved").wait_for()
    page.locator(".dialog").get_by_role("button", name="Save").click()
    page.get_by_text("must be a new name").wait_for()
    page.get_by_role("button", name="Close").click()
    with another_run(page):
        page.get_by_role("combobox", name="begin with").click()
        page.get_by_role("option", name="kept.toml").click()
    assert tissue.load(folder / "kept.toml").emt.cells == 3


def test_visitors_do_not_disturb_each_other_and_a_setting_outlives_a_reload(opened, site, page):
    with visit(opened, site) as one:
        for each in (one, page):
            wait_for_runs(each)
        before = numbers(page)
        change(one, "emt.cells", "1")
        wait_for_runs(one)
        known = numbers(one)
        assert known != before == numbers(page)
        one.reload()
        wait_for_runs(one)
        assert (numbers(one), field(one, "emt.cells").input_value()) == (known, "1")


def test_the_page_fits_a_telephone(opened, site):
    with visit(opened, site, min(WIDTHS)) as page:
        page.wait_for_function(f"{SHOWN}?.state === 'ready'")
        fits(page)


def test_a_sheet_turns_and_its_section_moves(opened, tmp_path):
    parameters = of_surface("plane", numerics__t_end="0.5 h", emt__cells=3, emt__a="0.1 h")
    write_base(tmp_path, Setting.of(parameters))
    with served(tmp_path, "small.toml") as (address, _), visit(opened, address) as page:
        page.wait_for_function(f"{SHOWN}?.playing === 'false' && {SHOWN}.status === 'SUCCESS'")
        player = page.locator(".player")
        turned, box = player.get_attribute("data-turn"), player.locator("canvas").bounding_box()
        page.mouse.move(box["x"] + 100, box["y"] + 100)
        page.mouse.down()
        page.mouse.move(box["x"] + 180, box["y"] + 130, steps=4)
        page.mouse.up()
        assert player.get_attribute("data-turn") != turned
        assert player.get_attribute("data-followed") is None  # a drag follows no cell
        first = tissue.simulate(finely_kept(parameters), run_seeds(SEED, "A", [0])[0])
        for z in (0.0, 2.5, -5.0):
            page.get_by_label("section", exact=True).evaluate(
                "(slider, z) => { slider.value = z; slider.dispatchEvent(new Event('input')); }", z
            )
            wanted = len(section(first.final, z / parameters.cell.soft_radius.value).cells.x)
            page.wait_for_function(f"n => {SHOWN}.shown == n", arg=wanted)
        page.wait_for_function("document.querySelector('[data-is=runs]').dataset.runs > 10")
        value, low, high = interval(numbers(page)["height [µm]"][0])
        assert 0 < low <= value <= high


def test_a_page_comes_back_when_its_server_does_and_ends_it(opened, tmp_path):
    write_base(tmp_path, THESIS.with_values(SMALL))
    with opened.new_page() as page:
        page.set_default_timeout(PATIENCE)
        with served(tmp_path, "small.toml") as (address, process):
            page.goto(address)
            change(page, "emt.cells", "2")
            wait_for_runs(page)
            known = numbers(page)
            process.kill()
            process.wait()
        with served(tmp_path, "small.toml", "--port", address.rsplit(":")[-1].strip("/")) as (_, process):
            page.reload()
            wait_for_runs(page)
            assert numbers(page) == known
            page.get_by_label("end the server").click()
            assert process.wait(60) == 0
