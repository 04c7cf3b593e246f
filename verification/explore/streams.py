"""Streams of pictures from the server to players: what a message is, and the addresses of streams.

Messages are one behind the other, little-endian: bytes of the header, bytes of the payload (uint32), the header as
JSON, the payload, columns of 4-byte numbers. First comes one of kind "head", then a "frame" for each output time, at
last the "end". Nobody can guess an address; each stream is fetched once, and ends when its reader has gone. Its first
piece is made while its address is still on the way to the reader.
"""

from __future__ import annotations

import asyncio
import json
import struct
import threading
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from secrets import token_urlsafe
from typing import TYPE_CHECKING, Any

from starlette.responses import Response, StreamingResponse

from dincl.errors import InvalidProblem
from dincl.status import Status

if TYPE_CHECKING:
    from fastapi import FastAPI


SIZES = struct.Struct("<II")
WORD = 4  # bytes, to which headers are filled up


def message(header: Mapping[str, Any], payload: bytes = b"") -> bytes:
    """Return one message; the payload is a multiple of 4 bytes."""
    text = json.dumps(header, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % WORD)
    return SIZES.pack(len(text), len(payload)) + text + payload


def ending(status: Status, detail: str) -> bytes:
    """Return the last message: how it ended, and where if it failed."""
    return message({"kind": "end", "status": status.name, "detail": detail})


def told(stream: Iterator[bytes]) -> Iterator[bytes]:
    """Pass a stream on; where it cannot begin or go on, end it with the reason."""
    try:
        yield from stream
    except InvalidProblem as error:
        yield message({"kind": "end", "status": "INVALID", "detail": str(error)})


Make = Callable[[Callable[[], bool]], Iterator[bytes]]
PATH = "/pictures"
MOST = 50  # that nobody has fetched yet
END = b""


class PictureStreams:
    """The streams that nobody has fetched yet."""

    def __init__(self, app: FastAPI) -> None:
        self._begun: OrderedDict[str, _Stream] = OrderedDict()
        app.add_api_route(f"{PATH}/{{name}}", self._answer, methods=["GET"], include_in_schema=False)

    def add(self, make: Make) -> str:
        """Begin a stream, from within the event loop; its address.

        ``make`` is called with a function that says whether the reader has gone. What it cannot do ends the stream.
        """
        name = token_urlsafe(16)
        self._begun[name] = _Stream(make)
        while len(self._begun) > MOST:
            self._begun.popitem(last=False)
        return f"{PATH}/{name}"

    async def _answer(self, name: str) -> Response:
        stream = self._begun.pop(name, None)
        if stream is None:
            return Response(status_code=404)
        return StreamingResponse(stream.pieces(), media_type="application/octet-stream")


class _Stream:
    """A stream whose first piece is made at once, in a thread, and the others as they are read."""

    def __init__(self, make: Make) -> None:
        self._gone = threading.Event()
        self._made = told(make(self._gone.is_set))
        self._first = asyncio.get_running_loop().run_in_executor(None, next, self._made, END)

    async def pieces(self) -> AsyncIterator[bytes]:
        """Give all pieces; when the reader goes, this is cancelled and the work ends."""
        try:
            piece = await self._first
            while piece:
                yield piece
                # A future of the loop: unlike a thread pool of Starlette it need not come to its end to be cancelled.
                piece = await asyncio.get_running_loop().run_in_executor(None, next, self._made, END)
        finally:
            self._gone.set()
