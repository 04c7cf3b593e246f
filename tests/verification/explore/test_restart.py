"""A page comes back with its setting when its server does; its button ends the server."""

import pytest

import tissue
from tests.browser import PATIENCE, launched
from tests.verification.explore.site import change, numbers, served, wait_for_runs, write_base
from tests.verification.explore.small import SMALL
from verification.explore.tissues.setting import Setting

RUNS = 400


@pytest.mark.slow
def test_a_page_comes_back_when_its_server_does(tmp_path):
    write_base(tmp_path, Setting("thesis", tissue.preset("thesis")).with_values(SMALL))
    with launched() as browser, browser.new_page() as page:
        page.set_default_timeout(PATIENCE)
        with served(tmp_path, "small.toml") as (address, process):
            page.goto(address)
            change(page, "emt.cells", "2")
            wait_for_runs(page, RUNS)
            known = numbers(page)
            process.kill()
            process.wait()
        with served(tmp_path, "small.toml", "--port", address.rsplit(":")[-1].strip("/")) as (_, process):
            page.reload()
            wait_for_runs(page, RUNS)
            assert numbers(page) == known
            page.get_by_label("end the server").click()
            assert process.wait(60) == 0
