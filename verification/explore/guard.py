"""Who may see the page: on the loopback who asks for it by its address; elsewhere who has the token.

No page of another site may ask in the name of a visitor, or show this one inside of itself.
"""

from __future__ import annotations

import ipaddress
from hmac import compare_digest
from http.cookies import CookieError, SimpleCookie
from typing import TYPE_CHECKING
from urllib.parse import parse_qs, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send


LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
COOKIE = "explore"
REFUSED = "This page needs the token that was printed when it was started: .../?token=..."
FOREIGN = "This comes from the page of another site."
# NiceGUI makes its page of scripts and templates in the page itself.
POLICY = {
    "default-src": "'self'",
    "script-src": "'self' 'unsafe-inline' 'unsafe-eval'",
    "style-src": "'self' 'unsafe-inline'",
    "img-src": "'self' data: blob:",
    "font-src": "'self' data:",
    **dict.fromkeys(("object-src", "base-uri", "form-action", "frame-ancestors"), "'none'"),
}
HEADERS = {
    "Content-Security-Policy": "; ".join(f"{what} {allowed}" for what, allowed in POLICY.items()),
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",  # the address may have a token
}


def is_loopback(host: str) -> bool:
    """Return whether only this machine can reach it."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class OneSite:
    """Refuses what comes from pages of other sites, sockets above all, and sends HEADERS with each answer."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
        elif _is_foreign(Headers(scope=scope)):
            await _refuse(FOREIGN, scope, receive, self._with_headers(send))
        else:
            await self._app(scope, receive, self._with_headers(send))

    def _with_headers(self, send: Send) -> Send:
        async def marked(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        return marked


class Token:
    """Lets through who brings the token in the address, or in the cookie that this sets; pages and sockets alike."""

    def __init__(self, app: ASGIApp, token: str) -> None:
        self._app, self._token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan" or self._is_it(_cookie(scope)):
            await self._app(scope, receive, send)
        elif self._is_it(_in_address(scope)):
            await self._app(scope, receive, self._with_cookie(send))
        else:
            await _refuse(REFUSED, scope, receive, send)

    def _is_it(self, given: str) -> bool:
        return compare_digest(given.encode(), self._token.encode())

    def _with_cookie(self, send: Send) -> Send:
        async def marked(message: Message) -> None:
            if message["type"] == "http.response.start":
                cookie = f"{COOKIE}={self._token}; HttpOnly; SameSite=Strict; Path=/"
                message["headers"] = [*message["headers"], (b"set-cookie", cookie.encode())]
            await send(message)

        return marked


async def _refuse(why: str, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "http":
        await PlainTextResponse(why, 403)(scope, receive, send)
    else:
        await send({"type": "websocket.close", "code": 1008})


def _is_foreign(headers: Headers) -> bool:
    """Return whether a browser says that another site asks; the scheme is that of a proxy, if there is one."""
    origin = headers.get("origin")
    return origin is not None and urlsplit(origin).netloc != headers.get("host", "")


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
