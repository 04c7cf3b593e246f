"""Which method to take: a small decision tree, fitted to half of the random scenes and tried on the other half."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.beyond.decisions.study import ALONE, AUTO, NO_REFERENCE
from verification.page.parts import number

# Errors that the tree is fitted for, in diameters of the largest disc; it is tried on the error of each scene.
TARGETS = (1e-2, 1e-3, 1e-4, 1e-5)
# A method is good enough if it costs at most so many times the cheapest one.
ENOUGH = 1.5
LEAVES, FEWEST = 6, 12
# Column -> words for "at most" and "more than" the value of a split.
FEATURES: Mapping[str, tuple[str, str]] = {
    "particles": ("particles: at most {}", "particles: more than {}"),
    "target": ("error at most {}", "error above {}"),
    "rough": ("smooth drift", "drift with jumps"),
    "moving": ("sets at rest", "sets that move"),
    "space": ("in the plane", "in space"),
}
# Features that are split on a logarithmic scale, and the digits that they are told with.
LOGARITHMIC = ("particles", "target")


def costs(table: pd.DataFrame, targets: Sequence[float] = ()) -> pd.DataFrame:
    """Return a row for each scene and target that some method reaches: features, and the CPU time of each method.

    Without targets, the one of each scene is the error that was asked for. A method reaches a target with the cheapest
    run that has the error, if all finer runs of its ladder have it, too.
    """
    runs = table[~table["method"].str.startswith((AUTO, ALONE, NO_REFERENCE))]
    rows = []
    for seed, mine in runs.groupby("seed"):
        first = mine.iloc[0]
        about = {"seed": seed, "particles": first["particles"], "rough": float(first["drift"] == "rough")}
        about |= {"moving": float("moving" in first["sets"] or "growing" in first["sets"])}
        about |= {"space": float(first["dimension"] == 3)}
        for target in targets or (first["asked"],):
            found = {str(name): _reached(ladder, target) for name, ladder in mine.groupby("method")}
            if np.isfinite(list(found.values())).any():
                rows.append(about | {"target": target} | found)
    return pd.DataFrame(rows).fillna(np.inf)


def _reached(ladder: pd.DataFrame, target: float) -> float:
    """Return the CPU time of the cheapest run from which on all have the error; inf if there is none."""
    ordered = ladder.sort_values("setting", ascending=False)
    late = ordered[(ordered["error"] > target).to_numpy()[::-1].cumsum()[::-1] == 0]
    return float(late["seconds"].min()) if len(late) else np.inf


@dataclass(frozen=True)
class Leaf:
    """A leaf of the tree: its conditions, in words, and the method to take."""

    conditions: tuple[str, ...]
    method: str


@dataclass(frozen=True, eq=False)
class DecisionTree:
    """The tree: its leaves, and their numbers for rows of ``costs``."""

    rules: Mapping[int, Leaf]
    fitted: Any

    def leaves(self, rows: pd.DataFrame) -> NDArray[np.int64]:
        """Return the number of the leaf of each row."""
        return np.asarray(self.fitted.apply(_features(rows)))


def _features(rows: pd.DataFrame) -> NDArray[np.float64]:
    given = rows[list(FEATURES)].astype(float)
    made: NDArray[np.float64] = given.assign(**{name: np.log10(given[name]) for name in LOGARITHMIC}).to_numpy()
    return made


def is_held_out(table: pd.DataFrame) -> pd.Series[bool]:
    """Return which rows are of scenes that the tree is tried on: those with odd seeds."""
    return table["seed"] % 2 == 1


def methods(rows: pd.DataFrame) -> list[str]:
    """List the methods that have a cost."""
    return [name for name in rows.columns if name not in (*FEATURES, "seed")]


def fit(rows: pd.DataFrame) -> DecisionTree:
    """Fit the tree to the cheapest method of each row of ``costs``."""
    from sklearn.tree import DecisionTreeClassifier

    names = methods(rows)
    cheapest = rows[names].to_numpy().argmin(axis=1)
    fitted = DecisionTreeClassifier(max_leaf_nodes=LEAVES, min_samples_leaf=FEWEST, random_state=0)
    fitted.fit(_features(rows), cheapest)
    rules: dict[int, Leaf] = {}
    _walk(fitted, 0, {}, [names[k] for k in fitted.classes_], rules)
    return DecisionTree(rules, fitted)


def _walk(fitted: Any, node: int, conditions: Mapping[str, str], names: Sequence[str], rules: dict[int, Leaf]) -> None:
    """Collect the leaves below a node; neighbours with one method are one, later bounds replace earlier ones."""
    tree, leaves = fitted.tree_, _below(fitted, node)
    taken = {names[int(tree.value[leaf][0].argmax())] for leaf in leaves}
    if len(taken) == 1:
        rules.update(dict.fromkeys(leaves, Leaf(tuple(conditions.values()), taken.pop())))
        return
    name = list(FEATURES)[tree.feature[node]]
    value = float(10 ** tree.threshold[node] if name in LOGARITHMIC else tree.threshold[node])
    told = f"{value:.0f}" if name == "particles" else number(float(f"{value:.1g}"))
    for child, words in zip((tree.children_left[node], tree.children_right[node]), FEATURES[name], strict=True):
        _walk(fitted, int(child), {**conditions, words: words.format(told)}, names, rules)


def _below(fitted: Any, node: int) -> list[int]:
    """List the leaves below a node, or the node itself if it is one."""
    left, right = (int(side[node]) for side in (fitted.tree_.children_left, fitted.tree_.children_right))
    return [node] if left < 0 else _below(fitted, left) + _below(fitted, right)


def tried(tree: DecisionTree, rows: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each leaf, and one for all: share within ``ENOUGH`` of the cheapest, median ratio."""
    names = methods(rows)
    least, leaf = rows[names].min(axis=1), tree.leaves(rows)
    taken = np.array([rows[tree.rules[k].method].iloc[i] for i, k in enumerate(leaf)])
    ratio = taken / least.to_numpy()
    found = [
        _leaf(", ".join(rule.conditions), rule.method, ratio[[tree.rules[k] == rule for k in leaf]])
        for rule in dict.fromkeys(tree.rules.values())
    ]
    return pd.DataFrame([*found, _leaf("all", "as above", ratio)])


def alone(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the same for each method that is always taken, the best one first."""
    least = rows[methods(rows)].min(axis=1)
    found = [_leaf("all", name, (rows[name] / least).to_numpy()) for name in methods(rows)]
    return pd.DataFrame(found).sort_values("share", ascending=False, kind="stable")


def _leaf(conditions: str, method: str, ratio: NDArray[np.float64]) -> dict[str, Any]:
    """Return the row of the cases with these ratios; the median says nothing where most do not reach the error."""
    told = {"conditions": conditions, "method": method, **share(ratio <= ENOUGH), "failed": int(np.isinf(ratio).sum())}
    return told | {"median": float(np.median(ratio)) if len(ratio) else np.nan}


def share(good: NDArray[np.bool_]) -> dict[str, Any]:
    """Return count, number, share and its 95 % interval (Wilson)."""
    from scipy.stats import binomtest

    count, of = int(good.sum()), len(good)
    if not of:
        return {"count": 0, "of": 0, "share": np.nan, "low": 0.0, "high": 1.0}
    low, high = binomtest(count, of).proportion_ci(method="wilson")
    return {"count": count, "of": of, "share": count / of, "low": low, "high": high}
