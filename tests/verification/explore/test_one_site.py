"""Pages of other sites are refused; streams are fetched once, by who knows the address."""

import asyncio
import threading

import httpx
import pytest
from fastapi import FastAPI

from verification.explore.server import OneSite
from verification.explore.streams import MOST, PictureStreams

APP = FastAPI()


@APP.get("/")
def page():
    """What only this site may see."""
    return "seen"


async def visit(app, *asked, **options):
    """The answers to some addresses, in one visit."""
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://here", **options) as one:
        return [await one.get(address) for address in asked]


def ask(*asked, **options):
    """The same, from outside of a loop."""
    return asyncio.run(visit(*asked, **options))


@pytest.mark.parametrize(
    ("origin", "host", "status"),
    [
        (None, "here", 200),
        ("http://here", "here", 200),
        ("https://here:8", "here:8", 200),  # behind a proxy
        ("http://here", "here:8", 403),
        ("http://there", "here", 403),
        ("http://here.there", "here", 403),
        ("null", "here", 403),
        ("", "here", 403),
    ],
)
def test_only_this_site_may_ask_and_no_other_shows_it(origin, host, status):
    (answer,) = ask(OneSite(APP), "/", headers={"host": host} | ({} if origin is None else {"origin": origin}))
    assert answer.status_code == status
    assert answer.headers["x-frame-options"] == "DENY"
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]


def test_a_stream_is_given_once_and_the_oldest_are_dropped():
    app = FastAPI()
    streams = PictureStreams(app)

    async def add_and_fetch():
        first = streams.add(lambda _: iter([b"old"]))
        address = streams.add(lambda gone: iter([b"one", b"two", str(gone()).encode()]))
        for _ in range(MOST - 1):
            streams.add(lambda _: iter([b"other"]))
        return await visit(app, address, address, first)

    given, again, dropped = asyncio.run(add_and_fetch())
    assert given.content == b"onetwoFalse"
    assert (again.status_code, dropped.status_code) == (404, 404)


def test_the_first_piece_is_made_before_it_is_fetched():
    made, later = threading.Event(), threading.Event()

    def pieces(_):
        made.set()
        yield b"one"
        later.set()
        yield b"two"

    async def add():
        PictureStreams(FastAPI()).add(pieces)
        return await asyncio.to_thread(made.wait, 10)

    assert asyncio.run(add())
    assert not later.is_set()


def test_who_leaves_ends_the_work_at_once():
    """Also in the middle of a piece that would take for ever."""
    begun, ended = threading.Event(), threading.Event()

    def pieces(gone):
        yield b"one"
        begun.set()
        while not gone():
            pass
        ended.set()

    async def read_and_leave():
        app = FastAPI()
        address = PictureStreams(app).add(pieces)
        asked = asyncio.create_task(visit(app, address))
        await asyncio.to_thread(begun.wait, 60)
        asked.cancel()
        return await asyncio.to_thread(ended.wait, 60)

    assert asyncio.run(read_and_leave())
