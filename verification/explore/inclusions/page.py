"""The tab of inclusions: a scene, a method and dt on the left, the particles in motion with overlap and error."""

from __future__ import annotations

import asyncio
from concurrent.futures import Executor
from typing import TYPE_CHECKING

from nicegui import background_tasks, ui

from verification.explore.common.widgets import Player, QuickSlider
from verification.explore.inclusions.frames import pictures
from verification.explore.inclusions.runs import METHODS, SCENES, Inclusion, InclusionRun, reference, scene

if TYPE_CHECKING:
    from verification.explore.common.streams import PictureStreams

FIRST = "ten_disks_corner"
# Of powers of 2: the steps at first, at least and at most.
STEPS, COARSEST, FINEST = 6, 2, 12
RULE = (
    "Overlap: the largest violation of a constraint. Error: the largest distance of a particle from the reference. "
    "Between two steps the picture is interpolated. For problems of your own, and errors against dt, see "
    "verification compare."
)


class InclusionsPage:
    """Choices and view of a visitor; a run begins when the tab is seen, and ends with its stream.

    Parameters
    ----------
    streams
        Gives a stream of pictures an address.
    executor
        Threads that make references.
    """

    def __init__(self, streams: PictureStreams, executor: Executor) -> None:
        self._streams, self._pool, self._inclusion = streams, executor, scene(FIRST)
        with ui.element("div").classes("columns inclusions") as whole:
            with ui.element("div").classes("left"):
                self._choices()
            with ui.element("div").classes("middle"):
                self._player = Player()
                ui.label(RULE).classes("about")
        whole.on("vnodeMounted", self._changed, js_handler="() => emit()")

    def _choices(self) -> None:
        titles = {name: scene(name).title for name in SCENES}
        self._chosen = ui.select(titles, value=FIRST, on_change=self._changed)
        self._chosen.props('dense outlined label="problem" aria-label="problem"')
        self._about = ui.label().classes("about").props('data-is="about"')
        self._known = ui.label().classes("about").props('data-is="reference"')
        self._method = ui.select(list(METHODS), value="PBD", on_change=self._changed)
        self._method.props('dense outlined label="method" aria-label="method"')
        self._dt = ui.label().classes("dt").props('data-is="dt"')
        with ui.element("div").classes("steps"):
            # To the right dt grows.
            self._steps = QuickSlider(min=-FINEST, max=-COARSEST, value=-STEPS, step=1, on_change=self._changed)
            self._steps.props('snap markers aria-label="dt"')

    def _changed(self) -> None:
        """Show what is chosen now."""
        self._inclusion = scene(str(self._chosen.value))
        run = InclusionRun(self._inclusion, str(self._method.value), 2 ** -int(self._steps.value))
        self._about.text = self._inclusion.about
        self._dt.text = f"dt = {self._inclusion.end:g}/{run.steps} = {run.dt:.3g}"
        self._player.play(self._streams.add(lambda gone: pictures(run, gone)))
        background_tasks.create(self._say_reference(self._inclusion), name="reference")

    async def _say_reference(self, inclusion: Inclusion) -> None:
        """Say what is known of the solution, once it is computed."""
        self._known.text = "Reference: being computed"
        found = await asyncio.get_running_loop().run_in_executor(self._pool, reference, inclusion)
        if inclusion is self._inclusion:
            self._known.text = f"Reference: {found.words}"
