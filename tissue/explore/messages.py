"""The stream of pictures from the server to a player: messages one behind the other, little-endian.

Each is: bytes of the header, bytes of the payload (uint32), the header as JSON, the payload, columns of 4-byte numbers.
First comes one of kind "head", then a "frame" for each kept time, at last the "end".
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator, Mapping
from typing import Any

from dincl.errors import InvalidProblem
from dincl.status import Status

MAKES_NO_NUMBERS = True

SIZES = struct.Struct("<II")
WORD = 4  # bytes, to which headers are filled up


def message(header: Mapping[str, Any], payload: bytes = b"") -> bytes:
    """One message; the payload is a multiple of 4 bytes."""
    text = json.dumps(header, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % WORD)
    return SIZES.pack(len(text), len(payload)) + text + payload


def ending(status: Status, detail: str) -> bytes:
    """The last message: how it ended, and where if it failed."""
    return message({"kind": "end", "status": status.name, "detail": detail})


def told(stream: Iterator[bytes]) -> Iterator[bytes]:
    """A stream that ends with the reason, where it cannot begin or go on."""
    try:
        yield from stream
    except InvalidProblem as error:
        yield message({"kind": "end", "status": "INVALID", "detail": str(error)})
