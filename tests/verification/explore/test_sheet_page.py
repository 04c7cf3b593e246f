"""A tissue in three dimensions on the page: it turns under the mouse, a slider moves the section, an answer comes."""

import numpy as np
import pytest

from tests.browser import launched, visit
from tests.tissue.space.in_space import SURFACES, of_surface
from tests.verification.explore.site import interval, numbers, served, wait_for_runs, write_base
from tests.verification.explore.test_frames import parsed
from tissue.frames.observables import ab_positions, height
from tissue.frames.section import section
from tissue.runs.simulate import simulate
from tissue.study.plan import run_seeds
from verification.explore.tissues.frames import finely_kept, stream
from verification.explore.tissues.session import SEED
from verification.explore.tissues.setting import Setting

BRIEF = {"numerics__t_end": "0.5 h", "emt__cells": 3, "emt__a": "0.1 h"}
LENGTHS = ("x", "y", "z", "ax", "ay", "az", "bx", "by", "bz", "radius")
COLUMNS = len(LENGTHS) + 6


@pytest.mark.slow_with("cylinder", "sphere")
@pytest.mark.parametrize("name", SURFACES)
def test_pictures_are_those_of_the_run(name):
    parameters = of_surface(name, **BRIEF)
    (head, _), *shown, (end, _) = parsed(stream(parameters, 2))
    run = simulate(finely_kept(parameters), 2)
    heights = run.summary().set_index("time_h")["height_um"]
    um = parameters.cell.soft_radius.value
    surface = run.final.sheets.surface
    assert (head["painter"], end["status"]) == ("sheet", "SUCCESS")
    assert head["surface"]["bends"] == surface.bends
    assert [period or np.inf for period in head["periods"]] == pytest.approx(
        [um * surface.period_x, um * surface.period_z]
    )
    assert len(shown) == len(run.frames)
    for (header, payload), frame in zip(shown, run.frames, strict=True):
        n = header["cells"]
        table = np.frombuffer(payload[: 4 * COLUMNS * n], "<f4").reshape(COLUMNS, n)
        assert (table[0].view("<i4") == frame.cells.id).all()
        for row, column in zip(table[1:], LENGTHS, strict=False):
            assert row == pytest.approx(um * getattr(frame.cells, column), rel=1e-6, abs=1e-5)
        assert table[-1] == pytest.approx(ab_positions(frame), abs=1e-5)
        assert header["height"] == (None if np.isnan(heights[frame.t]) else pytest.approx(um * height(frame)))
        members = np.frombuffer(payload[4 * COLUMNS * n :], "<i4")
        assert (members.reshape(-1, 3) == frame.sheets.apical.triangles).all()


@pytest.mark.slow
def test_a_sheet_turns_and_its_section_moves(tmp_path):
    parameters = of_surface("plane", **BRIEF)
    write_base(tmp_path, Setting.of(parameters))
    with launched() as browser, served(tmp_path, "small.toml") as (address, _), visit(browser, address) as page:
        wait_for_runs(page, 400, "A")
        value, low, high = interval(numbers(page)["height [µm]"][0])
        assert 0 < low <= value <= high
        player, canvas = page.locator(".player"), page.locator(".player canvas")
        page.wait_for_function("document.querySelector('.player').dataset.playing === 'false'")
        first = simulate(finely_kept(parameters), run_seeds(SEED, "A", [0])[0])
        turned = player.get_attribute("data-turn")
        box = canvas.bounding_box()
        page.mouse.move(box["x"] + 100, box["y"] + 100)
        page.mouse.down()
        page.mouse.move(box["x"] + 180, box["y"] + 130, steps=4)
        page.mouse.up()
        assert player.get_attribute("data-turn") != turned
        assert player.get_attribute("data-followed") is None  # a drag follows no cell
        um = parameters.cell.soft_radius.value
        for z in (0.0, 2.5, -5.0):
            page.get_by_label("section", exact=True).evaluate(
                "(slider, z) => { slider.value = z; slider.dispatchEvent(new Event('input')); }", z
            )
            wanted = len(section(first.final, z / um).cells.x)
            page.wait_for_function("n => document.querySelector('.player').dataset.shown == n", arg=wanted)
