"""The runs of a fit: Sobol points times replicates, eight runs side by side, in a table that can be resumed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any, get_args

import numpy as np
from scipy.stats import qmc

from dincl.study import Key, Row, Study
from tissue.fitting.plan import Fit
from tissue.kernels.lanes import WIDTH
from tissue.runs.batch import Batch
from tissue.runs.registration import own_code
from tissue.runs.tables import summary_row
from tissue.state.cells import Floats
from tissue.study.categories import What
from tissue.study.outcomes import measured
from tissue.study.plan import run_seeds

NAME = "design"


def sobol_points(fit: Fit, points: int) -> Floats:
    """Return points of the scrambled Sobol sequence, (points, d) in [0, 1]; fewer are the first ones of more."""
    sequence = qmc.Sobol(len(fit.ranges), seed=fit.seed)
    found: Floats = sequence.random_base2(max(1, math.ceil(math.log2(points))))[:points]
    return found


def design(fit: Fit) -> Study:
    """Return the runs of a fit: a row for each, with its point, its replicate, its status and what was measured.

    More points go into the same table.
    """
    batches = -(-fit.points * fit.replicates // WIDTH)
    settings: dict[str, Any] = {
        "base": fit.base.as_toml(),
        "parameters": str(fit.ranges),
        "outputs": ", ".join(sorted(fit.outputs)),
        "replicates": fit.replicates,
        "seed": fit.seed,
        **own_code(),
    }
    keys = tuple({"batch": number} for number in range(batches))
    run, by, unit = partial(_rows, fit), ("point", "replicate"), "batches"
    return Study(NAME, fit.title, ("batch",), keys, run, settings, by=by, unit=unit)


def _rows(fit: Fit, key: Key) -> list[Row]:
    """Make the runs of a batch. Those of a point follow one another."""
    places = [divmod(number, fit.replicates) for number in range(WIDTH * key["batch"], WIDTH * (key["batch"] + 1))]
    points = sobol_points(fit, places[-1][0] + 1)
    of_point = {point: fit.parameters(points[point]) for point in dict.fromkeys(point for point, _ in places)}
    seeds = [run_seeds(fit.seed, f"point {point}", [number])[0] for point, number in places]
    found = measure_runs([of_point[point] for point, _ in places], seeds, fit)
    return [
        {"batch": key["batch"], "point": point, "replicate": number, "seed": seed, **row}
        for (point, number), seed, row in zip(places, seeds, found, strict=True)
    ]


def measure_runs(parameters: Sequence[Any], seeds: Sequence[int], fit: Fit) -> list[dict[str, Any]]:
    """Simulate up to eight runs, each with its parameters; return the status and what the data have of each run.

    What was not measured is NaN: of a run that failed, or where the apical layer was folded.
    """
    batch, wanted = Batch(parameters, seeds), fit.data.groupby("time_h")["measure"].agg(list)
    rows: list[dict[str, Any]] = [{} for _ in seeds]
    for t in batch.times():
        for time, names in wanted.items():
            if math.isclose(time, t, abs_tol=1e-9):
                for k, row in enumerate(rows):
                    values = _values(batch, k, t, names)
                    row |= {f"{name}_{time:g}h": values[name] for name in names}
    return [{"status": batch.status(k).name, **row} for k, row in enumerate(rows)]


def _values(batch: Batch, k: int, t: float, names: Sequence[str]) -> dict[str, float]:
    """Return what is measured of run k at the present time, by name."""
    if (found := batch.measures[k]) is None:
        return dict.fromkeys(names, math.nan)
    shares = [name for name in names if name in get_args(What)]
    values = summary_row(batch.frame(k, t), found, batch.each[k], names) if len(shares) < len(names) else {}
    if shares:
        positions, beyond, lowest, _ = measured(batch, k, t)
        apical = beyond if batch.each[k].curve().ring else positions > 1
        hits = {"basal": positions < 0, "apical": apical, "below": positions <= lowest}
        hidden = not len(positions) or bool(np.isnan(positions).any())
        values |= {name: math.nan if hidden else float(hits[name].mean()) for name in shares}
    return {name: float(values[name]) for name in names}
