"""Closed tubes: does it matter for the ways out that a tissue cannot spread, and when does a lumen close?

``python -m verification.beyond.curved.tubes`` makes ``verification/data/curved_tubes.parquet`` and
``curved_lumen.parquet``, in ten minutes on one core.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from dincl.compiled.lanes import WIDTH
from dincl.study import progress
from tissue.files.parameters import Parameters, preset
from tissue.frames.frame import Frame
from tissue.runs.batch import Batch
from tissue.state.cells import CONTROL, EMT, Flags, Integers
from tissue.statistics.proportions import wilson
from tissue.study.outcomes import SIDES
from tissue.study.plan import run_seeds
from verification.beyond.curved.curved import file
from verification.page.kept import keep
from verification.thesis.chapter3.intervals import over_seeds

SEED = 219
EVENTS: dict[str, dict[str, object]] = {
    "[A]": {"emt.a": "12 h"},
    "[B]": {"emt.b": "12 h"},
    "[AB]": {"emt.a": "12 h", "emt.b": "12 h"},
    "[BP]": {"emt.b": "12 h", "emt.p": "24 h"},
}
# Cells that fill a tube within the largest basal distance, 5/3 um.
CELLS_PER_UM = 0.6
# Tubes whose lumen may close [um], and the runs of each.
LUMINA, LUMEN_RUNS = (400, 450, 500, 550), 24


class Layer(NamedTuple):
    """A basal layer, its EMT cells, evenly spaced, and how many runs are made of each set of events."""

    closed: bool
    side: str
    perimeter: int  # um
    cells: int
    emt: int
    runs: int
    events: tuple[str, ...] = tuple(EVENTS)

    def parameters(self, **more: object) -> Parameters:
        """Return the published parameters on this layer."""
        layer = {"shape": "circle", "perimeter": f"{self.perimeter} um", "closed": self.closed, "side": self.side}
        given: dict[str, object] = {f"layer.{key}": value for key, value in layer.items()}
        return preset("published").changed(
            {"tissue.cells": self.cells, "emt.cells": self.emt, "numerics.keep": "6 h", **given, **more}
        )


def tube(side: str, perimeter: int, every: int, runs: int, events: tuple[str, ...] = tuple(EVENTS)) -> Layer:
    """Return a closed tube in which one of ``every`` cells is an EMT cell."""
    cells = int(CELLS_PER_UM * perimeter) + 1
    return Layer(True, side, perimeter, cells, cells // every, runs, events)


# The second one shows whether EMT cells that are closer are in each other's way.
LAYERS = (
    tube("outside", 400, 15, 48),
    tube("outside", 400, 30, 48, ("[A]",)),
    tube("inside", 600, 15, 32),
    Layer(False, "inside", 600, 51, 1, 512, ("[A]", "[BP]")),
    tube("outside", 600, 15, 24, ("[A]", "[BP]")),
)


def main() -> None:
    """Make and keep both tables."""
    keep(pd.DataFrame(_ways_out()), file("tubes"), main)
    keep(pd.DataFrame(_lumina()), file("lumen"), main)


def _ways_out() -> Iterator[dict[str, object]]:
    """Return a row for each layer, set of events and side: EMT cells that ended there, of complete runs."""
    for layer in LAYERS:
        for events in layer.events:
            sides, spacing = _ended(layer, events)
            for side in (SIDES[0], SIDES[-1]):
                hits = sides == SIDES.index(side) - 1
                low, high = _interval(hits)
                yield {
                    "events": events,
                    "closed": layer.closed,
                    "layer": layer.side,
                    "perimeter_um": layer.perimeter,
                    "every": layer.cells // layer.emt,
                    "side": side,
                    "count": int(hits.sum()),
                    "of": hits.size,
                    "value": float(hits.mean()),
                    "low": low,
                    "high": high,
                    "runs": layer.runs,
                    "failed": layer.runs - len(sides),
                    "basal_spacing_um": spacing,
                }


def _ended(layer: Layer, events: str) -> tuple[Integers, float]:
    """Return where the EMT cells of each run end (runs, m): -1, 0, 1; and the mean basal distance there [um]."""
    parameters = layer.parameters(**EVENTS[events])
    name = f"{events} {layer.side} {layer.perimeter} {layer.closed} {layer.emt}"
    seeds, sides, spacings = run_seeds(SEED, name, range(layer.runs)), [], []
    with progress(name, layer.runs, "runs") as watch:
        for begin in range(0, layer.runs, WIDTH):
            batch = _grown(parameters, seeds[begin : begin + WIDTH])
            for k in filter(batch.goes_on, range(len(batch.seeds))):
                sides.append(batch.state(k).emt.side.copy())
                spacings.append(_spacing(batch.frame(k, parameters.t_end), parameters))
            watch(begin + len(batch.seeds))
    return np.array(sides), float(np.mean(spacings))


def _interval(hits: Flags) -> tuple[float, float]:
    """Return the 95 % interval of the ratio of hits (runs, m): Wilson's for one cell a run, else Student's over runs.

    The cells of one run share a tissue.
    """
    if hits.shape[1] == 1:
        low, high = wilson(hits.mean(), hits.size)
        return float(low), float(high)
    found = over_seeds(hits.mean(axis=1))
    return max(found.low, 0.0), min(found.high, 1.0)


def _grown(parameters: Parameters, seeds: Sequence[int]) -> Batch:
    """Run tissues to their ends; their EMT cells start apart, not side by side in the middle."""
    first = Batch(parameters, seeds)
    t = next(first.times())
    batch = Batch(parameters, seeds, [_apart(first.frame(k, t)) for k in range(len(seeds))])
    for _ in batch.times():
        pass
    return batch


def _apart(frame: Frame) -> Frame:
    """Return the same start with its EMT cells evenly spaced."""
    cells = frame.cells
    n, m = len(cells.x), int((cells.emt >= 0).sum())
    chosen = n * (2 * np.arange(m) + 1) // (2 * m)
    emt, kind, divides = np.full(n, -1), np.full(n, CONTROL), np.ones(n, np.bool_)
    emt[chosen], kind[chosen], divides[chosen] = np.arange(m), EMT, False
    return frame._replace(cells=cells._replace(emt=emt, kind=kind, divides=divides))


def _spacing(frame: Frame, parameters: Parameters) -> float:
    """Return the mean distance of neighbours in the basal layer."""
    layer = np.append(frame.layers.basal, frame.layers.basal[: frame.curve.ring])
    x, y = frame.cells.bx[layer], frame.cells.by[layer]
    return parameters.cell.soft_radius.value * float(np.hypot(np.diff(x), np.diff(y)).mean())


def _lumina() -> Iterator[dict[str, object]]:
    """Return a row for each perimeter, tissue inside and without EMT cells: how many lumina close, and when."""
    for perimeter in LUMINA:
        parameters = tube("inside", perimeter, 15, LUMEN_RUNS).parameters(**{"emt.cells": 0})
        seeds, times = run_seeds(SEED, f"lumen {perimeter}", range(LUMEN_RUNS)), []
        with progress(f"lumen {perimeter}", LUMEN_RUNS, "runs") as watch:
            for begin in range(0, LUMEN_RUNS, WIDTH):
                times += _closed(Batch(parameters, seeds[begin : begin + WIDTH]))
                watch(begin + WIDTH)
        low, high = wilson(len(times) / LUMEN_RUNS, LUMEN_RUNS)
        yield {
            "perimeter_um": perimeter,
            "runs": LUMEN_RUNS,
            "closed": len(times),
            "value": len(times) / LUMEN_RUNS,
            "low": float(low),
            "high": float(high),
            "first_h": min(times, default=None),
            "median_h": float(np.median(times)) if times else None,
        }


def _closed(batch: Batch) -> list[float]:
    """Return the times at which lumina close [h]."""
    end = batch.parameters.t_end
    for _ in batch.times():
        if not any(map(batch.goes_on, range(len(batch.seeds)))):
            break
    return [batch.frame(k, end).t for k in range(len(batch.seeds)) if not batch.goes_on(k)]


if __name__ == "__main__":
    main()
