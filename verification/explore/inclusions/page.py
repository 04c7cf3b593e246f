"""The tab of inclusions: a problem, a method and dt on the left, the particles in motion with overlap and error."""

from __future__ import annotations

import asyncio
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from nicegui import background_tasks, ui

from dincl.errors import InvalidProblem
from verification.explore.common.folder import Folder
from verification.explore.common.widgets import Player, QuickSlider
from verification.explore.inclusions.frames import pictures
from verification.explore.inclusions.problems import (
    METHODS,
    SCENES,
    Inclusion,
    checked_end,
    from_file,
    reference,
    scene,
)
from verification.explore.inclusions.runs import InclusionRun

if TYPE_CHECKING:
    from verification.explore.common.streams import PictureStreams

FIRST = "ten_disks_corner"
# Of powers of 2: the steps at first, at least and at most.
STEPS, COARSEST, FINEST = 6, 2, 12
RULE = (
    "Overlap: the largest violation of a constraint. Error: the largest distance of a particle from the reference. "
    "Between two steps the picture is interpolated. For errors against dt see verification compare."
)


class InclusionsPage:
    """Choices and view of a visitor; a run begins when the tab is seen, and ends with its stream.

    Parameters
    ----------
    folder
        Where the files of Python lie of which one may be chosen.
    streams
        Gives a stream of pictures an address.
    executor
        Threads that make references.
    """

    def __init__(self, folder: Folder, streams: PictureStreams, executor: Executor) -> None:
        self._folder, self._streams, self._pool = folder, streams, executor
        self._inclusion, self._end, self._asked = scene(FIRST), scene(FIRST).end, 0
        with ui.element("div").classes("columns inclusions") as whole:
            with ui.element("div").classes("left"):
                self._problem()
                self._method()
            with ui.element("div").classes("middle"):
                self._player = Player()
                ui.label(RULE).classes("about")
        whole.on("vnodeMounted", self._changed, js_handler="() => emit()")

    def _problem(self) -> None:
        with ui.element("div").classes("row"):
            self._chosen = ui.select(self._offered(), value=FIRST, on_change=self._choose)
            self._chosen.props('dense outlined label="problem" aria-label="problem"').classes("grow")
            again = ui.button("Read again", on_click=self._choose).props("dense flat no-caps size=sm")
            again.tooltip("the list of files in the folder, and the file that is chosen")
        self._fault = ui.label().classes("faults").props('role="alert" data-is="problem-fault"')
        self._about = ui.label(self._inclusion.about).classes("about").props('data-is="about"')
        self._known = ui.label().classes("about").props('data-is="reference"')

    def _method(self) -> None:
        self._pictured = ui.select(list(METHODS), value="PBD", on_change=self._changed)
        self._pictured.props('dense outlined label="method" aria-label="method"')
        self._dt = ui.label().classes("dt").props('data-is="dt"')
        with ui.element("div").classes("steps"):
            # To the right dt grows.
            self._steps = QuickSlider(min=-FINEST, max=-COARSEST, value=-STEPS, step=1, on_change=self._changed)
            self._steps.props('snap markers aria-label="dt"')
        self._last = ui.number("end time", value=self._end, format="%g").props('dense outlined aria-label="end time"')
        self._last.classes("short").on("change", self._set_end)
        self._wrong = ui.label().classes("faults").props('role="alert" data-is="end-fault"')

    def _offered(self) -> dict[str, str]:
        """Return scenes and files of the folder, by what is chosen."""
        own = self._folder.python_files()
        return {name: scene(name).title for name in SCENES} | {name: name for name in own}

    async def _choose(self) -> None:
        """Take another problem; the newest choice counts, and one that cannot be leaves everything as it is."""
        self._asked = asked = self._asked + 1
        self._chosen.set_options(self._offered())
        self._fault.text = ""
        try:
            found = await self._read(self._chosen.value)
        except InvalidProblem as error:
            found, self._fault.text = None, str(error) if asked == self._asked else self._fault.text
        if found is None or asked != self._asked:
            return
        self._inclusion, self._end = found, found.end
        self._last.value, self._wrong.text, self._about.text = found.end, "", found.about
        self._changed()

    async def _read(self, name: Any) -> Inclusion:
        if name in SCENES:
            return scene(name)
        if name not in self._folder.python_files():
            raise InvalidProblem(f"problem = {name}: must be a scene, or a file of Python in the folder")
        return await asyncio.get_running_loop().run_in_executor(self._pool, from_file, self._folder.path(name))

    def _set_end(self) -> None:
        try:
            self._end, self._wrong.text = checked_end(self._inclusion, self._last.value), ""
        except InvalidProblem as error:
            self._wrong.text = str(error)
        else:
            self._changed()

    def _changed(self) -> None:
        """Show what is chosen now."""
        steps = 2 ** -int(self._steps.value)
        run = InclusionRun(self._inclusion, str(self._pictured.value), steps, self._end)
        self._dt.text = f"dt = {self._end:g}/{steps} = {run.dt:.3g}"
        self._player.play(self._streams.add(lambda gone: pictures(run, gone)))
        background_tasks.create(self._say_reference(self._inclusion, self._end), name="reference")

    async def _say_reference(self, inclusion: Inclusion, end: float) -> None:
        """Say what is known of the solution, once it is computed."""
        self._known.text = "Reference: being computed"
        found = await asyncio.get_running_loop().run_in_executor(self._pool, reference, inclusion.problem, end)
        if (inclusion, end) == (self._inclusion, self._end):
            self._known.text = f"Reference: {found.words}"
