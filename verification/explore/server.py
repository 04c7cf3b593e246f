"""The server of the page: a port of this machine, one page for each visitor, and nothing from elsewhere.

It listens on the loopback alone. No page of another site may ask in the name of a visitor, or show this one in itself.
"""

from __future__ import annotations

import json
import socket
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit
from webbrowser import open as open_browser

import uvicorn
from fastapi import FastAPI, Request
from nicegui import Client, ui
from nicegui import app as core_app
from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.responses import PlainTextResponse

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.kernels.lanes import WIDTH
from tissue.study.outcomes import outcomes
from verification.explore.ensemble import workers
from verification.explore.folder import Folder
from verification.explore.frames import stream
from verification.explore.page import TissuePage
from verification.explore.session import SEED, Session
from verification.explore.setting import Setting
from verification.explore.streams import PictureStreams

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from tissue.files.parameters import Parameters


THIS_MACHINE = "127.0.0.1"
TITLE = "tissue explore"
GRACE = 2  # seconds for answers under way, once it is to end
PATIENCE = 50.0  # seconds until a page has come back by its socket; without it, NiceGUI drops it after 60
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
}


class OneSite:
    """Refuses what comes from pages of other sites, sockets above all, and sends HEADERS with each answer."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def marked(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        if scope["type"] == "lifespan" or not _is_foreign(Headers(scope=scope)):
            await self._app(scope, receive, marked)
        elif scope["type"] == "http":
            await PlainTextResponse("This comes from the page of another site.", 403)(scope, receive, marked)
        else:
            await send({"type": "websocket.close", "code": 1008})


def _is_foreign(headers: Headers) -> bool:
    """Return whether a browser says that another site asks; the scheme is that of a proxy, if there is one."""
    origin = headers.get("origin")
    return origin is not None and urlsplit(origin).netloc != headers.get("host", "")


@dataclass(frozen=True)
class Site:
    """Resources that all visitors share; ``end`` ends the server."""

    folder: Folder
    base: str
    changes: Mapping[str, Any]
    streams: PictureStreams
    pool: Executor
    end: Callable[[], None]

    def session(self, query: Mapping[str, str]) -> Session:
        """Begin the session that the query of an address names, by default that with which the server was started.

        Raises
        ------
        InvalidProblem
            If the address is of a setting that cannot be, or takes files of Python that are not imported.
        """
        base = query.get("base", self.base)
        try:
            changes = json.loads(query["set"]) if "set" in query else {} if "base" in query else self.changes
            seed = int(query.get("seed", SEED))
        except (ValueError, RecursionError) as error:
            raise InvalidProblem(f"the address of the page: cannot be read: {error}") from error
        if not isinstance(changes, Mapping):
            raise InvalidProblem(f"the address of the page: set = {describe(changes)}: must be values by their keys")
        setting = Setting(base, self.folder.parameters(base, chosen=False)).with_values(changes)
        return Session.begin(self.folder, self.pool, setting, seed)


def serve(folder: Folder, base: str, changes: Mapping[str, Any], port: int, *, browser: bool) -> None:
    """Serve the page until Ctrl-C, SIGTERM or the button of the page.

    Parameters
    ----------
    folder, base, changes
        What a page begins with: a preset or a file of the folder, and changes.
    port
        Where to listen; 0: one that is free.
    browser
        Whether to open one.

    Raises
    ------
    InvalidProblem
        If the beginning is not in order, or it cannot listen there.
    """
    warm_up(Setting(base, folder.parameters(base)).with_values(changes).parameters)
    try:
        listening = socket.create_server((THIS_MACHINE, port))
    except OSError as error:
        raise InvalidProblem(f"--port {port}: cannot be listened to: {error}") from error
    server = uvicorn.Server(uvicorn.Config(app := FastAPI(openapi_url=None), log_level="warning"))
    server.config.timeout_graceful_shutdown = GRACE
    # A page from elsewhere may have another name lead here.
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=[THIS_MACHINE, "localhost"], www_redirect=False)
    app.add_middleware(OneSite)
    with workers() as pool:
        _publish(
            app, Site(folder, base, changes, PictureStreams(app), pool, lambda: setattr(server, "should_exit", True))
        )
        address = f"http://{THIS_MACHINE}:{listening.getsockname()[1]}/"
        print(f"{address}\nCtrl-C ends it.", flush=True)
        if browser:
            open_browser(address)
        server.run(sockets=[listening])


def _publish(app: FastAPI, site: Site) -> None:
    """Publish the one page, which each visitor gets anew.

    To ask for it has no effects: nothing is imported, and nothing is run before the page has come back by its socket.
    """
    css = files("verification.explore").joinpath("page.css").read_text("utf-8")

    @ui.page("/", title=TITLE)
    async def visit(request: Request) -> None:
        ui.add_css(css)
        try:
            session = site.session(request.query_params)
        except InvalidProblem as error:
            ui.label(str(error)).classes("faults").props('role="alert"')
            ui.link("Begin anew", "/")
            return
        client = ui.context.client
        await client.connected(PATIENCE)
        if not client.is_deleted:  # it is, if the server ends before the page has come back
            TissuePage(session, site.streams, site.end)

    core_app.on_shutdown(_leave)
    ui.run_with(
        app,
        title=TITLE,
        tailwind=False,
        binding_refresh_interval=None,
        gzip_middleware_factory=None,
        show_welcome_message=False,
    )


def _leave() -> None:
    """End the work of all visitors, for which the end of the server would wait."""
    for client in list(Client.instances.values()):
        client.delete()


def warm_up(parameters: Parameters) -> None:
    """Make a few steps of all that the page runs; on a new machine this compiles for half a minute."""
    brief = parameters.changed(
        {"numerics.t_end": str(parameters.numerics.dt), "numerics.keep": str(parameters.numerics.dt)}
    )
    for _ in stream(brief, 0):
        pass
    outcomes(brief, range(WIDTH), range(WIDTH))
