"""The server of the page: a port of this machine, one page for each visitor, and nothing from elsewhere."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from importlib.resources import files
from secrets import token_urlsafe
from typing import TYPE_CHECKING, Any
from webbrowser import open as open_browser

import uvicorn
from fastapi import FastAPI, Request
from nicegui import Client, ui
from nicegui import app as core_app
from starlette.middleware.trustedhost import TrustedHostMiddleware

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.kernels.lanes import WIDTH
from tissue.study.outcomes import outcomes
from verification.explore.common.folder import Folder, NeedsPython
from verification.explore.common.streams import PictureStreams
from verification.explore.guard import LOOPBACK, OneSite, Token, is_loopback
from verification.explore.page import build
from verification.explore.tissues.ensemble import workers
from verification.explore.tissues.frames import stream
from verification.explore.tissues.session import SEED, Session
from verification.explore.tissues.setting import Setting

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters


TITLE = "tissue explore"
GRACE = 2  # seconds for answers under way, once it is to end
PATIENCE = 50.0  # seconds until a page has come back by its socket; without it, NiceGUI drops it after 60


@dataclass(frozen=True)
class Site:
    """Resources that all visitors share; ``end`` ends the server, and is None where visitors may not do that."""

    folder: Folder
    base: str
    changes: Mapping[str, Any]
    streams: PictureStreams
    pool: Executor
    end: Callable[[], None] | None

    def session(self, query: Mapping[str, str], *, agreed: bool = False) -> Session:
        """Begin the session that an address names; without one the session that the server was started with.

        Parameters
        ----------
        query
            Of the address.
        agreed
            Whether files of Python may be imported that its base names.

        Raises
        ------
        InvalidProblem
            If the address is of a setting that cannot be; NeedsPython if it takes files that are not imported.
        """
        base = query.get("base", self.base)
        try:
            changes = json.loads(query["set"]) if "set" in query else {} if "base" in query else self.changes
            seed = int(query.get("seed", SEED))
        except (ValueError, RecursionError) as error:
            raise InvalidProblem(f"the address of the page: cannot be read: {error}") from error
        if not isinstance(changes, Mapping):
            raise InvalidProblem(f"the address of the page: set = {describe(changes)}: must be values by their keys")
        setting = Setting(base, self.folder.parameters(base, agreed=agreed)).with_values(changes)
        return Session.begin(self.folder, self.pool, setting, seed)


def serve(folder: Folder, base: str, changes: Mapping[str, Any], host: str, port: int, *, browser: bool) -> None:
    """Serve the page until Ctrl-C, SIGTERM or, on the loopback, the button of the page.

    Parameters
    ----------
    folder, base, changes
        What a page begins with: a preset or a file of the folder, and changes.
    host, port
        Where to listen; port 0: one that is free. Away from the loopback who has no token sees nothing.
    browser
        Whether to open one.

    Raises
    ------
    InvalidProblem
        If the beginning is not in order, or it cannot listen there.
    """
    warm_up(Setting(base, folder.parameters(base, agreed=True)).with_values(changes).parameters)
    listening, token = _listen(host, port), "" if is_loopback(host) else token_urlsafe(16)
    server = uvicorn.Server(uvicorn.Config(app := FastAPI(openapi_url=None), log_level="warning"))
    server.config.timeout_graceful_shutdown = GRACE
    _protect(app, token)
    with workers() as pool:
        end = None if token else lambda: setattr(server, "should_exit", True)
        _publish(app, Site(folder, base, changes, PictureStreams(app), pool, end))
        address = f"http://{_shown(host)}:{listening.getsockname()[1]}/{f'?token={token}' if token else ''}"
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
        client = ui.context.client
        session = _begun(site, request.query_params, client.content)
        if session is not None:
            await client.connected(PATIENCE)
            if not client.is_deleted:  # it is, if the server ends before the page has come back
                build(session, site.streams, site.pool, site.end)

    core_app.on_shutdown(_leave)
    ui.run_with(
        app,
        title=TITLE,
        tailwind=False,
        binding_refresh_interval=None,
        gzip_middleware_factory=None,
        show_welcome_message=False,
    )


def _begun(site: Site, query: Mapping[str, str], whole: ui.element, *, agreed: bool = False) -> Session | None:
    """Begin the session of a visitor; None if that fails: then the page says why, and what may be done."""
    with whole:
        try:
            return site.session(query, agreed=agreed)
        except InvalidProblem as error:
            ui.label(str(error)).classes("faults").props('role="alert"')
            if isinstance(error, NeedsPython):
                ui.button("Import them and begin", on_click=lambda: _agree(site, query, whole)).props("dense no-caps")
            ui.link("Begin anew", "/")
    return None


def _agree(site: Site, query: Mapping[str, str], whole: ui.element) -> None:
    """Begin once the visitor has agreed, with a click in a page that the server knows by its own name for it."""
    whole.clear()
    session = _begun(site, query, whole, agreed=True)
    if session is not None:
        with whole:
            build(session, site.streams, site.pool, site.end)


def _leave() -> None:
    """End the work of all visitors, for which the end of the server would wait."""
    for client in list(Client.instances.values()):
        client.delete()


def _protect(app: FastAPI, token: str) -> None:
    """Answer on the loopback to its names alone: a page from elsewhere may have another name lead here."""
    if token:
        app.add_middleware(Token, token=token)
    else:
        app.add_middleware(TrustedHostMiddleware, allowed_hosts=list(LOOPBACK), www_redirect=False)
    app.add_middleware(OneSite)


def _listen(host: str, port: int) -> socket.socket:
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family)
    except (OSError, OverflowError) as error:
        raise InvalidProblem(f"--host {host} --port {port}: cannot be listened to: {error}") from error


def _shown(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def warm_up(parameters: Parameters) -> None:
    """Make a few steps of all that the page runs; on a new machine this compiles for half a minute."""
    brief = parameters.changed(
        {"numerics.t_end": str(parameters.numerics.dt), "numerics.keep": str(parameters.numerics.dt)}
    )
    for _ in stream(brief, 0):
        pass
    outcomes(brief, range(WIDTH), range(WIDTH))
