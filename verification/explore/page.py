"""The page of one visitor: knobs on the left, the tissue in motion, the answer on the right."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from typing import Any
from urllib.parse import urlencode

from nicegui import context, run, ui
from nicegui.element import Element

from dincl.errors import InvalidProblem
from verification.explore import dialogs
from verification.explore.answer_panel import AnswerPanel
from verification.explore.frames import stream
from verification.explore.knob_panel import KnobPanel
from verification.explore.session import Session
from verification.explore.streams import PictureStreams

CALM = 0.05  # seconds without a change, after which an ensemble begins: the picture comes first
LOOK = 0.02  # seconds between two looks at it


class Player(Element, component="player.js", esm={"tissue-pictures": "js"}):
    """Player of streams of ``explore.streams``; data attributes of its element say what it shows."""

    def play(self, url: str) -> None:
        """Show another run, from its first frames on, at the time that is shown now."""
        self._props["url"] = url
        self.update()


class TissuePage:
    """View of a session, whose work ends when the visitor has gone; ``end`` ends the server."""

    def __init__(self, session: Session, streams: PictureStreams, end: Callable[[], None]) -> None:
        self._session, self._streams = session, streams
        self._beginning: asyncio.Task[None] | None = None
        with ui.element("div").classes("bar"):
            ui.label("tissue explore").classes("title")
            ui.button("End", on_click=end).props('dense flat no-caps size=sm aria-label="end the server"')
        with ui.element("div").classes("columns"):
            with ui.element("div").classes("left"):
                self._head()
                self._knobs = KnobPanel(session, self._changed)
            with ui.element("div").classes("middle"):
                self._player = Player()
                self._replicates()
            with ui.element("div").classes("right"):
                self._answer = AnswerPanel(session, self._compare, self._more)
                with ui.element("div").classes("row"):
                    button = ui.button("Make this a study", on_click=lambda: dialogs.make_study(session))
                    button.props("dense no-caps flat size=sm")
        self._timer = ui.timer(LOOK, self._look, active=False)
        context.client.on_delete(self._stop)
        self._changed()

    def _stop(self) -> None:
        """End all work of the visitor."""
        self._session.stop()
        self._timer.cancel()

    def _head(self) -> None:
        session = self._session
        with ui.element("div").classes("row"):
            self._base = ui.select(
                session.bases(), value=session.now.setting.base, on_change=lambda e: self._open(e.value)
            )
            self._base.props('dense outlined label="begin with" aria-label="begin with"').classes("grow")
        with ui.element("div").classes("row"):
            for text, act in (
                ("Save", lambda: dialogs.save_parameters(session, lambda: self._base.set_options(session.bases()))),
                ("Undo all", lambda: self._open(session.now.setting.base)),
            ):
                ui.button(text, on_click=act).props("dense no-caps flat size=sm")

    def _replicates(self) -> None:
        """Add the fields that choose the run that is shown, and the seed."""
        session = self._session
        with ui.element("div").classes("row"):
            self._shown = ui.number("run shown", value=0, min=0, step=1, format="%d").props("dense outlined")
            self._shown.classes("short").on("change", self._play)
            seed = ui.number("seed of the study", value=session.seed, min=0, step=1, format="%d")
            seed.props("dense outlined").classes("short").on("change", lambda: self._reseed(seed.value))

    def _changed(self) -> None:
        """Show another setting: the picture at once, its ensemble when the knob rests."""
        self._play()
        self._answer.show()
        if self._beginning is not None:
            self._beginning.cancel()
        self._beginning = asyncio.create_task(self._begin())

    async def _begin(self) -> None:
        await asyncio.sleep(CALM)
        self._session.start()
        self._timer.activate()
        self._note()

    def _play(self) -> None:
        parameters, seed = self._session.now.setting.parameters, self._session.seed_of(int(self._shown.value or 0))
        self._player.play(self._streams.add(lambda gone: stream(parameters, seed, gone)))

    async def _look(self) -> None:
        """Take in the runs that have come; rest when no more will."""
        sides = [side for side in (self._session.now, self._session.held) if side is not None]
        behind = [side for side in sides if side.is_behind()]
        over = all(side.ensemble.over for side in sides)
        for side in behind:
            await run.io_bound(side.catch_up)
        if behind or over:
            self._answer.show()
        if over and not any(side.is_behind() for side in sides):
            self._timer.deactivate()

    def _open(self, name: str) -> None:
        try:
            self._session.open(name)
        except InvalidProblem as error:
            ui.notify(str(error), type="negative", multi_line=True)
            return
        self._knobs.rebuild()
        self._changed()

    def _compare(self) -> None:
        session = self._session
        session.hold() if session.held is None else session.release()
        self._changed()

    def _more(self, runs: int) -> None:
        self._session.start(max(1, runs))
        self._timer.activate()

    def _reseed(self, seed: Any) -> None:
        try:
            self._session.reseed(int(seed or 0))
        except InvalidProblem as error:
            ui.notify(str(error), type="negative")
        else:
            self._changed()

    def _note(self) -> None:
        """Keep the setting in the address, so that it comes back when the page is loaded again."""
        setting = self._session.now.setting
        known = {"base": setting.base, "seed": self._session.seed, "set": json.dumps(setting.changes)}
        self._player.client.run_javascript(f"history.replaceState(null, '', {json.dumps('?' + urlencode(known))})")
