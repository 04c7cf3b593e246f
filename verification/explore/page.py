"""The page of one visitor: two tabs, of the tissue and of inclusions."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor

from nicegui import context, ui

from verification.explore.common.streams import PictureStreams
from verification.explore.inclusions.page import InclusionsPage
from verification.explore.tissues.page import TissuePage
from verification.explore.tissues.session import Session

TISSUE, INCLUSIONS = "Tissue", "Inclusions"


def build(session: Session, streams: PictureStreams, pool: Executor, end: Callable[[], None] | None) -> None:
    """Build the page; its work ends when the visitor has gone. ``end`` is what the button does that ends the server."""
    with ui.element("div").classes("bar"):
        ui.label("tissue explore").classes("title")
        with ui.tabs().props("dense no-caps") as tabs:
            ui.tab(TISSUE)
            ui.tab(INCLUSIONS)
        if end is not None:
            ui.button("End", on_click=end).props('dense flat no-caps size=sm aria-label="end the server"')
    with ui.tab_panels(tabs, value=TISSUE, animated=False, keep_alive=True).classes("panels"):
        with ui.tab_panel(TISSUE):
            page = TissuePage(session, streams)
        with ui.tab_panel(INCLUSIONS):
            InclusionsPage(streams, pool)
    context.client.on_delete(page.stop)
