"""The tab of inclusions: a problem, methods and dt on the left, the particles in motion, overlap and error."""

from __future__ import annotations

import asyncio
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dincl.errors import InvalidProblem
from tissue.explore.folder import Folder
from tissue.explore.inclusion_charts import COARSEST, COLOURS, FINEST
from tissue.explore.inclusion_frames import pictures
from tissue.explore.inclusion_results import InclusionResults
from tissue.explore.inclusion_runs import InclusionRun
from tissue.explore.inclusion_work import InclusionWork
from tissue.explore.inclusions import METHODS, SCENES, Inclusion, checked_end, from_file, scene
from tissue.explore.player import Player
from tissue.explore.sliders import QuickSlider

if TYPE_CHECKING:
    from tissue.explore.streams import PictureStreams

MAKES_NO_NUMBERS = True

FIRST, SHOWN = "ten_disks_corner", ("PBD", "catch-up", "midpoint catch-up", "penalty 100")
STEPS = 6  # at first, a power of 2
RULE = (
    "Overlap: the largest violation of a constraint. Error: the largest distance of a particle from the reference. "
    "Both are those at the steps; between two steps the picture is interpolated. Order: the slope of the largest error "
    "between 2 dt and dt."
)


class InclusionsPage:
    """What a visitor sees and has chosen; work begins when it is seen.

    Parameters
    ----------
    folder
        Where the files of Python lie of which one may be chosen.
    streams
        Gives a stream of pictures an address.
    executor
        Threads that make the runs.
    """

    def __init__(self, folder: Folder, streams: PictureStreams, executor: Executor) -> None:
        self._folder, self._streams, self._pool = folder, streams, executor
        self._inclusion, self._end, self._asked = scene(FIRST), scene(FIRST).end, 0
        with ui.element("div").classes("columns inclusions") as whole:
            with ui.element("div").classes("left"):
                self._problem()
                self._time()
                self._methods()
            with ui.element("div").classes("middle"):
                self._player = Player()
                ui.label(RULE).classes("about")
            with ui.element("div").classes("right"):
                self._results = InclusionResults()
        self._work = InclusionWork(executor, self._show)
        whole.on("vnodeMounted", self._changed, js_handler="() => emit()")

    def stop(self) -> None:
        """End all work."""
        self._work.stop()
        self._results.stop()

    def _problem(self) -> None:
        with ui.element("div").classes("row"):
            self._chosen = ui.select(self._offered(), value=FIRST, on_change=self._choose)
            self._chosen.props('dense outlined label="problem" aria-label="problem"').classes("grow")
            again = ui.button("Read again", on_click=self._choose).props("dense flat no-caps size=sm")
            again.tooltip("the list of files in the folder, and the file that is chosen")
        self._fault = ui.label().classes("faults").props('role="alert" data-is="problem-fault"')
        self._about = ui.label(self._inclusion.about).classes("about").props('data-is="about"')
        self._known = ui.label().classes("about").props('data-is="reference"')

    def _time(self) -> None:
        self._dt = ui.label().classes("dt").props('data-is="dt"')
        with ui.element("div").classes("steps"):
            # To the right dt grows.
            self._steps = QuickSlider(min=-FINEST, max=-COARSEST, value=-STEPS, step=1, on_change=self._changed)
            self._steps.props('snap markers aria-label="dt"')
        self._last = ui.number("end time", value=self._end, format="%g").props('dense outlined aria-label="end time"')
        self._last.classes("short").on("change", self._set_end)
        self._wrong = ui.label().classes("faults").props('role="alert" data-is="end-fault"')

    def _methods(self) -> None:
        self._pictured = ui.select(list(METHODS), value=SHOWN[0], on_change=self._changed)
        self._pictured.props('dense outlined label="method in the picture" aria-label="method in the picture"')
        self._boxes = {}
        with ui.element("div").classes("methods"):
            ui.label("beside it in the charts").classes("about")
            for method, colour in COLOURS.items():
                with ui.element("div"):
                    ui.element("i").classes("dot").style(f"background: {colour}")
                    self._boxes[method] = ui.checkbox(method, value=method in SHOWN, on_change=self._changed)
                    self._boxes[method].props("dense")

    def _offered(self) -> dict[str, str]:
        """Scenes and files of the folder, by what is chosen."""
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
        """Show what is chosen now: the picture and what is known already at once, the rest as it comes."""
        steps, first = 2 ** -int(self._steps.value), str(self._pictured.value)
        run = InclusionRun(self._inclusion, first, steps, self._end)
        self._dt.text = f"dt = {self._end:g}/{steps} = {run.dt:.3g}"
        self._player.play(self._streams.add(lambda gone: pictures(run, gone)))
        methods = [method for method, box in self._boxes.items() if box.value or method == first]
        self._work.look_at(self._inclusion, self._end, methods, first, steps)

    def _show(self) -> None:
        self._known.text = f"Reference: {self._work.words or 'being computed'}"
        self._results.show(self._work.compared())
