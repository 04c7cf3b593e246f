"""What an address, a page of another site or a visitor who leaves can do to the server: nothing that others notice."""

import asyncio
import json
import re
import time
from urllib.parse import quote

import httpx
import pytest
import socketio

from tests.verification.explore.site import Visitor, cpu_ticks, get, served, visiting

pytestmark = pytest.mark.slow

LONG = {"numerics.t_end": "1e7 h", "numerics.keep": "1e7 h"}
TICKS = 100  # of CPU time in a second
QUIET = 0.3  # seconds in which a process without work uses no tick
PATIENCE = 120  # seconds
PLUGIN = (
    "from pathlib import Path\nwith Path(__file__).with_suffix('.ran').open('a') as file:\n    file.write('x')\n{}\n"
)
BAD = [
    *("set=5", "set=null", "set=[1]", "set=%22text%22", "set={", "set=" + "[" * 20_000, "set={%22a%22:NaN}"),
    *("set={%22emt.cells%22:1e400}", "set={%22emt.cells%22:{%22a%22:1}}", "set={%22own.modules%22:[%22exits.py%22]}"),
    *("seed=" + "9" * 4000, "seed=" + "9" * 5000, "seed=-1", "seed=1.5", "seed="),
    *("base=itself.toml", "base=one.toml", "base=nothing.toml", "base=%00", "base=..", "base=", "base=exits.toml"),
]


def plugin(folder, name, text):
    """A parameter file that needs a file of Python, which notes each time that it is run."""
    (folder / f"{name}.py").write_text(PLUGIN.format(text))
    (folder / f"{name}.toml").write_text(f'base = "thesis"\n[own]\nmodules = ["{name}.py"]\n')


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("requests")
    plugin(folder, "exits", "raise SystemExit(3)")
    plugin(folder, "unasked", "")
    for name, base in (("itself", "itself"), ("one", "two"), ("two", "one")):
        (folder / f"{name}.toml").write_text(f'base = "{base}.toml"')
    return folder


@pytest.fixture(scope="module")
def site(folder):
    with served(folder) as found:
        yield found


@pytest.fixture(scope="module")
def address(site):
    return site[0]


def runs_of(folder, name):
    """How often a plugin was run."""
    noted = folder / f"{name}.ran"
    return len(noted.read_text()) if noted.exists() else 0


def wait_for(what):
    until = time.monotonic() + PATIENCE
    while not (found := what()) and time.monotonic() < until:
        time.sleep(0.02)
    return found


def is_quiet(process):
    before = cpu_ticks(process.pid)
    time.sleep(QUIET)
    return cpu_ticks(process.pid) == before


@pytest.mark.parametrize("query", BAD, ids=lambda query: query[:20])
def test_an_address_that_cannot_be_gives_a_page_with_a_message(query, address):
    answer = asyncio.run(get(address, f"?{query}"))
    assert answer.status_code == 200
    assert '"role":"alert"' in answer.text
    assert "Begin anew" in answer.text


def test_a_get_imports_nothing(address, folder):
    answer = asyncio.run(get(address, "?base=unasked.toml"))
    assert "unasked.toml: needs unasked.py: an address imports no files of Python" in answer.text
    assert runs_of(folder, "unasked") == 0


def test_a_page_without_a_socket_costs_nothing(site):
    address, process = site
    before = cpu_ticks(process.pid)

    async def ask():
        return [await get(address, f"?seed={k}") for k in range(20)]

    assert {answer.status_code for answer in asyncio.run(ask())} == {200}
    assert cpu_ticks(process.pid) - before < 4 * TICKS  # 0.1 s, and a page each would be 35


@pytest.mark.parametrize("origin", ["http://elsewhere.example", "null", "http://127.0.0.1", "http://localhost:1"])
def test_pages_of_other_sites_get_no_answer(origin, address):
    answer = asyncio.run(get(address, Origin=origin))
    assert answer.status_code == 403

    async def socket():
        visitor = Visitor(address, (await get(address)).text)
        try:
            with pytest.raises(socketio.exceptions.ConnectionError):
                await visitor.connect(origin)
        finally:
            await visitor.socket.disconnect()
        polled = f"_nicegui_ws/socket.io/?EIO=4&transport=polling&client_id={visitor.client}"
        return await get(address, polled, Origin=origin)

    assert asyncio.run(socket()).status_code == 403


def test_answers_forbid_frames_and_what_comes_from_elsewhere(address):
    headers = asyncio.run(get(address)).headers
    assert headers["x-frame-options"] == "DENY"
    policy = dict(part.strip().split(" ", 1) for part in headers["content-security-policy"].split(";"))
    assert policy["frame-ancestors"] == policy["object-src"] == "'none'"
    assert policy["default-src"] == "'self'"
    assert not re.search(r"https?:|\*", headers["content-security-policy"])


async def watch(visitor):
    """Begin to fetch the pictures of the page, and go in the middle of them."""
    path = re.search(r"/pictures/[\w-]+", await visitor.hear("/pictures/"))[0]
    async with httpx.AsyncClient(timeout=60) as http, http.stream("GET", visitor.address.rstrip("/") + path) as answer:
        async for _ in answer.aiter_bytes():
            return


def test_work_without_an_end_ends_when_its_visitor_has_left(site):
    address, process = site
    assert wait_for(lambda: is_quiet(process))

    async def visit():
        before = cpu_ticks(process.pid)
        async with visiting(address, f"?set={quote(json.dumps(LONG))}") as visitor:
            await watch(visitor)
            while cpu_ticks(process.pid) < before + TICKS:
                await asyncio.sleep(0.05)

    asyncio.run(visit())
    assert wait_for(lambda: is_quiet(process))


def test_work_without_an_end_does_not_keep_the_server(folder):
    with served(folder) as (address, process):

        async def visit():
            async with visiting(address, f"?set={quote(json.dumps(LONG))}") as visitor:
                await visitor.hear("/pictures/")
                await asyncio.sleep(0.3)
                process.terminate()
                return await asyncio.to_thread(process.wait, PATIENCE)

        assert asyncio.run(visit()) in (0, -15)


def test_a_server_that_ends_before_a_page_has_come_back_says_nothing_of_it(folder):
    with served(folder) as (address, process):
        assert asyncio.run(get(address)).status_code == 200
        process.terminate()
        process.wait(PATIENCE)
        assert process.stdout.read() == "Ctrl-C ends it.\n"
