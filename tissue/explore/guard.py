"""Who may see the page: on the loopback who asks for it by its address; elsewhere who has the token."""

from __future__ import annotations

import ipaddress
from hmac import compare_digest
from http.cookies import CookieError, SimpleCookie
from typing import TYPE_CHECKING
from urllib.parse import parse_qs

from starlette.responses import PlainTextResponse

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

MAKES_NO_NUMBERS = True

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
COOKIE = "explore"
REFUSED = "This page needs the token that was printed when it was started: .../?token=..."


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach it."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class Token:
    """Lets through who brings the token in the address, or in the cookie that this sets; pages and sockets alike."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        self._app, self._token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan" or self._is_it(_cookie(scope)):
            await self._app(scope, receive, send)
        elif self._is_it(_in_address(scope)):
            await self._app(scope, receive, self._with_cookie(send))
        elif scope["type"] == "http":
            await PlainTextResponse(REFUSED, 403)(scope, receive, send)
        else:
            await send({"type": "websocket.close", "code": 1008})

    def _is_it(self, given: str) -> bool:
        return compare_digest(given.encode(), self._token.encode())

    def _with_cookie(self, send: Send) -> Send:
        async def marked(message: Message) -> None:
            if message["type"] == "http.response.start":
                cookie = f"{COOKIE}={self._token}; HttpOnly; SameSite=Strict; Path=/"
                message["headers"] = [*message["headers"], (b"set-cookie", cookie.encode())]
            await send(message)

        return marked


def _cookie(scope: Scope) -> str:
    header = dict(scope["headers"]).get(b"cookie", b"").decode("latin-1")
    try:
        found = SimpleCookie(header).get(COOKIE)
    except CookieError:
        return ""
    return str(found.value) if found else ""


def _in_address(scope: Scope) -> str:
    query: str = scope["query_string"].decode("latin-1")
    return parse_qs(query).get("token", [""])[0]
