"""Heterogeneous groups, Table 5 of chapter 4: who leaves basally, by events, their times, the place at the onset.

Two tables of the same ensembles: ratios of cells of one kind, and how much each factor tells of all cells, by a model
of all cells at once. A time of an event is only there if the event is. So it is a factor of its own among the cells
that have the event, beside the factor whether they have it; the others carry the mean time.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.checks import seed as checked_seed
from dincl.errors import InvalidProblem
from dincl.study import Key, Row, Study
from tissue.study.categories import EVENTS, kept_times, outcome, time_column
from tissue.study.estimates import LEVEL
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS, ensemble, made
from verification.thesis.chapter4.ratios import NO_INM, by_order, given, happened, quantile, ratios

# Importance of factors.
FOLDS = 5
SHUFFLES = 5  # of each factor in each fold
MOST_CELLS = 20_000  # about 10 s; more cells are thinned to whole replicates of about so many
FEWEST = 25  # cells with and without the outcome that a model needs
# Small slow trees: of those tried on tables with known causes they fit least to chance.
TREES = {"learning_rate": 0.05, "max_leaf_nodes": 8, "min_samples_leaf": 50, "early_stopping": False, "random_state": 0}
LEAST_PROBABILITY = 1e-6  # of an outcome, so that its logarithm stays finite

Floats = NDArray[np.float64]


class Factor(NamedTuple):
    """One thing that may matter: columns that are shuffled together, among the cells that have it."""

    name: str
    columns: tuple[str, ...]
    among: NDArray[np.bool_]


def factors_of_cells(cells: pd.DataFrame, end: float) -> tuple[pd.DataFrame, list[Factor]]:
    """Return the factors of EMT cells: INM, each event and its time, onset, neighbours with [P], place in the group.

    Parameters
    ----------
    cells
        Table of the EMT cells; whole replicates, as neighbours are counted in it.
    end
        Of the runs [h]; later events did not happen.

    Returns
    -------
    pd.DataFrame, list[Factor]
        Numbers, all finite: ``inm``; ``A`` and ``A time`` [h] and so on; ``onset`` (4.8); ``others with [P]`` [cells of
        the replicate]; ``place`` [0 to 1, left to right]. And the factors: columns that are the same for all cells they
        concern are none. An event without its time would be no case of the model: the two are shuffled together.
    """
    had = happened(cells, end)
    columns: dict[str, Floats] = {"inm": cells["inm"].to_numpy(dtype=np.float64)}
    among = dict.fromkeys(("inm", *EVENTS, "others with [P]", "place"), np.ones(len(cells), dtype=np.bool_))
    for event in EVENTS:
        columns[event], among[f"{event} time"] = had[event].to_numpy(dtype=np.float64), had[event].to_numpy()
        columns[f"{event} time"] = _filled(cells[time_column(event)], among[f"{event} time"])
    onset = cells["onset_ab"].to_numpy(dtype=np.float64, na_value=np.nan)
    among["onset"] = np.isfinite(onset)
    columns["onset"] = _filled(pd.Series(onset), among["onset"])
    protruding = had["P"].groupby(cells["replicate"]).transform("sum") - had["P"]
    columns["others with [P]"] = protruding.to_numpy(dtype=np.float64)
    columns["place"] = cells["cell"].to_numpy(dtype=np.float64) / max(1, int(cells["cell"].max()))
    table = pd.DataFrame(columns, index=cells.index)
    together = {name: tuple(part for part in (name, f"{name} time") if part in columns) for name in columns}
    varying = [name for name in columns if table.loc[among[name], name].nunique() > 1]
    return table, [Factor(name, together[name], among[name]) for name in varying]


def _filled(values: pd.Series, there: NDArray[np.bool_]) -> Floats:
    """Return the values that are there, and their mean for the others; 0 if there are none."""
    numbers = values.to_numpy(dtype=np.float64)
    return np.where(there, numbers, numbers[there].mean() if there.any() else 0.0)


def shuffled(part: pd.DataFrame, factor: Factor, test: NDArray[np.intp], rng: np.random.Generator) -> Floats:
    """Return the numbers of some cells with the columns of a factor in another order among those that have it.

    ``test`` are the positions of these cells in the table that the factor is of.
    """
    rows = np.flatnonzero(factor.among[test])
    columns = [part.columns.get_loc(name) for name in factor.columns]
    values: Floats = part.to_numpy(copy=True)
    values[np.ix_(rows, columns)] = values[np.ix_(rng.permutation(rows), columns)]
    return values


def by_importance(cells: pd.DataFrame, hits: pd.Series, end: float, *, seed: int) -> pd.DataFrame:
    """Rank by permutation importance: how much the log loss of a model grows if a factor is shuffled among cells.

    The model, boosted regression trees, is fitted five times to four fifths of the replicates; losses are those of the
    cells of the other fifth. A time is shuffled among the cells that have the event, an event together with its time.
    Two factors that tell the same share their importance. Where they depend on each other, as the times of [B] and [P]
    do, shuffling one makes cases that the model has hardly seen: importances near 0 are then no finding.

    Parameters
    ----------
    cells, hits
        Table of the EMT cells; whether each has the outcome.
    end
        Of the runs [h].
    seed
        Of the thinning, folds and shuffles: the result is a function of it and the table.

    Returns
    -------
    pd.DataFrame
        ``factor``; ``value``: mean growth of the log loss per cell [nats], with the 95 % interval ``low``, ``high`` by
        the scatter over replicates, which does not hold that of the fit; the largest first. In each row: ``cells`` that
        entered, the mean ``loss`` of the model, and ``without`` it, with the ratio of all cells as the only
        prediction. A model whose loss is not clearly smaller has found nothing.

    Raises
    ------
    InvalidProblem
        If fewer than ``FEWEST`` cells have the outcome, or have it not, or there are fewer than five replicates.

    Source
    ------
    L. Breiman, Random forests, Machine Learning 45 (2001), section 10.
    """
    cells, hits = _thinned(cells, hits, checked_seed("seed", seed))
    numbers, found = factors_of_cells(cells, end)
    y, runs = hits.to_numpy(dtype=np.int64), cells["replicate"].to_numpy()
    losses, growth = _losses(numbers, found, y, runs, np.random.default_rng(seed))
    rows = [(factor.name, *_mean_over(growth[:, k], runs)) for k, factor in enumerate(found)]
    table = pd.DataFrame(rows, columns=["factor", "value", "low", "high"])
    table = table.iloc[np.argsort(-table["value"].abs().to_numpy(), kind="stable")].reset_index(drop=True)
    p = float(y.mean())
    without = float(-p * np.log(p) - (1 - p) * np.log1p(-p))
    return table.assign(cells=len(y), loss=float(losses.mean()), without=without)


def _losses(
    numbers: pd.DataFrame, found: list[Factor], y: NDArray[np.int64], runs: Any, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Compute the log loss of each cell by the model that has not seen its replicate, and its growth by each factor."""
    from sklearn.ensemble import HistGradientBoostingClassifier
    from sklearn.model_selection import StratifiedGroupKFold

    losses, growth = np.empty(len(y)), np.empty((len(y), len(found)))
    folds = StratifiedGroupKFold(FOLDS, shuffle=True, random_state=int(rng.integers(2**31)))
    for train, test in folds.split(numbers, y, runs):
        model = HistGradientBoostingClassifier(**TREES)
        model.fit(numbers.iloc[train].to_numpy(), y[train])
        part = numbers.iloc[test]
        losses[test] = _log_loss(model, part.to_numpy(), y[test])
        for k, factor in enumerate(found):
            grown = [_log_loss(model, shuffled(part, factor, test, rng), y[test]) for _ in range(SHUFFLES)]
            growth[test, k] = np.mean(grown, axis=0) - losses[test]
    return losses, growth


def _log_loss(model: Any, x: Floats, y: NDArray[np.int64]) -> Floats:
    """Compute - log of the probability that the model gave to what happened [nats]."""
    right: Floats = model.predict_proba(x)[np.arange(len(y)), y]
    return -np.log(np.maximum(right, LEAST_PROBABILITY))


def _mean_over(values: Floats, runs: Any) -> tuple[float, float, float]:
    """Return the mean over cells and its interval from the scatter over replicates."""
    mean = float(values.mean())
    rests = pd.Series(values - mean).groupby(runs).sum()
    half = quantile(LEVEL) * float(np.sqrt((rests**2).sum())) / len(values)
    return mean, mean - half, mean + half


def _thinned(cells: pd.DataFrame, hits: pd.Series, seed: int) -> tuple[pd.DataFrame, pd.Series]:
    """Return whole replicates with about ``MOST_CELLS`` cells, if there are more."""
    runs = cells["replicate"].unique()
    keep = int(len(runs) * MOST_CELLS / max(1, len(cells)))
    if keep < len(runs):
        chosen = cells["replicate"].isin(np.random.default_rng(seed).choice(runs, keep, replace=False))
        cells, hits, runs = cells[chosen], hits[chosen], runs[:keep]
    with_it = int(hits.sum())
    if min(with_it, len(hits) - with_it) < FEWEST or len(runs) < FOLDS:
        raise InvalidProblem(
            f"{with_it} of {len(hits)} cells in {len(runs)} replicates have the outcome: for a ranking at least "
            f"{FEWEST} must have it and {FEWEST} not, in {FOLDS} replicates or more"
        )
    return cells, hits


# Edges of the position at the onset (Figure 21), and of the event times [h] (Figure 20).
ONSETS, TIMES = tuple(np.arange(11) / 10), tuple(range(6, 25, 3))
EDGES = {"onset_ab": ONSETS, "t_a_h": TIMES, "t_b_h": TIMES, "t_p_h": TIMES}
INM = {"INM": "", "no INM": NO_INM}
# ``given`` of the rows by the events of a cell in their order, and of those of one order by the time of [A], for (Q4).
BY_EVENTS, ORDERS = "events", ("[AB]", "[BA]")
FIRST_RUNS = 2000  # of each ensemble, for the rows by order
RANKED, SEED = "table5_35", 0
SMALLEST = {"study": "table5_35_published", "replicates": 24}
COLUMNS = {
    "study": "Group",
    "given": "By",
    "kind": "Cells",
    "low_edge": "From",
    "high_edge": "To",
    "value": "Basal extrusion",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
    "of": "Cells of this kind",
    "runs": "Runs",
}
RANKING_COLUMNS = {
    "study": "Group",
    "factor": "Factor",
    "value": "Loss without it [nats]",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
}


def study(smallest: bool = False) -> Study:
    """Count who leaves, by kind of cell."""
    every = [name + ending for ending in PRESETS.values() for name in POPULATIONS]
    columns, by = COLUMNS, ("given", "kind", "low_edge")
    return Study("emt_groups", "EMT: groups", ("study", "replicates"), _runs(every, smallest), kinds, {}, columns, by)


def ranking(smallest: bool = False) -> Study:
    """Rank the factors of basal extrusion in the middle group."""
    runs, columns = _runs([RANKED + ending for ending in PRESETS.values()], smallest), RANKING_COLUMNS
    return Study("emt_ranking", "EMT: factors", ("study", "replicates"), runs, factors, {}, columns, ("factor",))


def _runs(names: list[str], smallest: bool) -> tuple[dict[str, Any], ...]:
    keys = ({"study": name, "replicates": ensemble(name).replicates} for name in names)
    return (SMALLEST,) if smallest else tuple(sorted(keys, key=lambda key: -key["replicates"]))


def _cells(study: str, replicates: int) -> tuple[pd.DataFrame, pd.Series, float]:
    """Return the cells of a group, whether they are extruded basally at the end, and when that is [h]."""
    plan = ensemble(study)
    (scenario,) = plan.scenarios
    cells, _ = made(plan.scenarios[scenario], plan.seed, scenario, replicates)
    end = kept_times(cells)[-1]
    return cells, outcome(cells, "basal", end), end


def kinds(key: Key) -> list[Row]:
    """Return a row for each kind of cell that occurs."""
    rows = pd.concat(list(_kinds(*_cells(**key))), ignore_index=True)
    return [{**key, **row} for row in rows.to_dict("records")]


def _kinds(cells: pd.DataFrame, basal: pd.Series, end: float) -> Iterator[pd.DataFrame]:
    """Give ratios by the order of events; by place and times, without [P] but for its time; by [A] in two orders."""
    replicate, order, with_p = cells["replicate"], by_order(cells, end), happened(cells, end)["P"]
    yield ratios(basal, replicate, order).rename_axis("kind").reset_index().assign(given=BY_EVENTS)

    def among(kind: pd.Series, column: str) -> pd.DataFrame:
        return given(basal[kind], replicate[kind], cells.loc[kind, column], EDGES[column])

    for text, ending in INM.items():
        for column in EDGES:
            chosen = (with_p if column == "t_p_h" else ~with_p) & (cells["inm"] == (not ending))
            yield among(chosen, column).assign(given=column, kind=text)
        for name in ORDERS:
            chosen = (order == name + ending) & (replicate < FIRST_RUNS)
            yield among(chosen, "t_a_h").assign(given=name, kind=text)


def factors(key: Key) -> list[Row]:
    """Return a row for each factor: the loss of a prediction of basal extrusion without it."""
    cells, basal, end = _cells(**key)
    return [{**key, **row} for row in by_importance(cells, basal, end, seed=SEED).to_dict("records")]
