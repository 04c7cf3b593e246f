"""Streams of pictures by addresses that nobody can guess: each is fetched once, and ends when its reader has gone."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable, Iterator
from secrets import token_urlsafe
from typing import TYPE_CHECKING

from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse

if TYPE_CHECKING:
    from fastapi import FastAPI

MAKES_NO_NUMBERS = True

Make = Callable[[Callable[[], bool]], Iterator[bytes]]
PATH = "/pictures"
MOST = 200  # that nobody has fetched yet
END = b""


class PictureStreams:
    """What makes the streams that were promised."""

    def __init__(self, app: FastAPI) -> None:
        self._made: OrderedDict[str, Make] = OrderedDict()
        app.add_api_route(f"{PATH}/{{name}}", self._answer, methods=["GET"], include_in_schema=False)

    def add(self, make: Make) -> str:
        """The address of a new stream.

        ``make`` is called when it is fetched, with a function that says whether the reader has gone.
        """
        name = token_urlsafe(16)
        self._made[name] = make
        while len(self._made) > MOST:
            self._made.popitem(last=False)
        return f"{PATH}/{name}"

    async def _answer(self, name: str) -> Response:
        make = self._made.pop(name, None)
        if make is None:
            return Response(status_code=404)
        return StreamingResponse(_pieces(make), media_type="application/octet-stream")


async def _pieces(make: Make) -> AsyncIterator[bytes]:
    """The pieces of a stream, each made in a thread; when the reader goes this is cancelled, and the work told so."""
    gone = threading.Event()
    stream = make(gone.is_set)
    try:
        while piece := await run_in_threadpool(next, stream, END):
            yield piece
    finally:
        gone.set()
