"""The tab of inclusions: a problem, methods and dt on the left, the particles in motion, overlap and error."""

from __future__ import annotations

import asyncio
from concurrent.futures import Executor
from time import monotonic
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dincl.errors import InvalidProblem
from verification.explore.common.folder import Folder
from verification.explore.common.widgets import Player, QuickSlider, draw, empty_chart, number_table
from verification.explore.inclusions.charts import COARSEST, COLOURS, FINEST, Compared, What, against_dt, in_time
from verification.explore.inclusions.frames import pictures
from verification.explore.inclusions.problems import METHODS, SCENES, Inclusion, checked_end, from_file, scene
from verification.explore.inclusions.runs import InclusionRun
from verification.explore.inclusions.work import InclusionWork

if TYPE_CHECKING:
    from verification.explore.common.streams import PictureStreams


PAUSE = 0.15  # seconds between two drawings
COLUMNS = {"method": "method", "error": "largest error", "overlap": "overlap", "order": "order"}
DOT = """<q-td :props="props" :style="{fontWeight: props.row.pictured ? 600 : 400}">
<i class="dot" :style="{background: props.row.colour}"></i>{{ props.row.method }}</q-td>"""
WHAT: tuple[What, ...] = ("error", "overlap")


class InclusionResults:
    """Results of the runs that are compared."""

    def __init__(self) -> None:
        self._table = number_table(COLUMNS, row_key="method")
        self._table.add_slot("body-cell-method", DOT)
        self._faults = ui.label().classes("faults").props('data-is="run-faults"')
        kinds = [(what, against) for against in (against_dt, in_time) for what in WHAT]
        self._charts = [(_chart(f"{what} {against.__name__}"), what, against) for what, against in kinds]
        self._drawn = 0.0
        self._later: asyncio.TimerHandle | None = None

    def show(self, runs: Compared) -> None:
        """Show all that is known, now or, if it was drawn just before, a little later: the browser has more to do."""
        self._runs = runs
        if self._later is None:
            wait = max(0.0, self._drawn + PAUSE - monotonic())
            self._later = asyncio.get_running_loop().call_later(wait, self._draw)

    def stop(self) -> None:
        """Draw no more."""
        if self._later is not None:
            self._later.cancel()

    def _draw(self) -> None:
        runs, self._later, self._drawn = self._runs, None, monotonic()
        self._table.props(f"data-left={runs.left()}")
        self._table.rows = [_row(runs, method) for method in runs.methods]
        found = {method: runs.known.get((method, runs.steps)) for method in runs.methods}
        said = [f"{method}: {one.fault}" for method, one in found.items() if one is not None and one.fault]
        self._faults.text = "\n".join(said)
        self._faults.set_visibility(bool(said))
        for chart, what, against in self._charts:
            draw(chart, against(what, runs))


def _chart(name: str) -> ui.echart:
    return empty_chart().props(f'data-is="{name}"')


def _row(runs: Compared, method: str) -> dict[str, Any]:
    """Return the numbers of a method at the present dt."""
    found, order = runs.known.get((method, runs.steps)), runs.order(method)
    row: dict[str, Any] = {"method": method, "colour": COLOURS[method], "pictured": method == runs.pictured}
    row["order"] = "" if order is None else f"{order:.1f}"
    if found is not None and found.fault:
        return row | {"error": "failed", "overlap": ""}
    values = {what: runs.largest(what, method, runs.steps) for what in WHAT}
    return row | {what: "" if value is None else f"{value:.1e}" if value else "0" for what, value in values.items()}


FIRST, SHOWN = "ten_disks_corner", ("PBD", "catch-up", "midpoint catch-up", "penalty 100")
STEPS = 6  # at first, a power of 2
RULE = (
    "Overlap: the largest violation of a constraint. Error: the largest distance of a particle from the reference. "
    "Both are those at the steps; between two steps the picture is interpolated. Order: the slope of the largest error "
    "between 2 dt and dt."
)


class InclusionsPage:
    """Choices and view of a visitor; work begins when the tab is seen.

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
