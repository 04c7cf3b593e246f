"""The simplest model that is enough: simplifications one by one, then together, by backward elimination."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any, Protocol

from dincl.extras import needs
from tissue.statistics.equivalence import ERROR, Equivalence

if TYPE_CHECKING:
    import pandas as pd

# Joins the names of the simplifications of a combination.
AND = " + "
# CPU times of which one is at most so many times the other are equal; counted work decides between them.
TIE = 1.1
COLUMNS = ["model", "parts", "step", "verdict", "bias", "low", "high", "runs", "missing", "cpu", "work", "reason"]
Row = dict[str, Any]


class Decider(Protocol):
    """Comparison of simpler models with the full one."""

    def decide(self, models: Sequence[str], error: float, *, again: bool) -> list[Row]:
        """Return ``compared(...)`` of each model, the names of a combination joined by AND.

        "enough" may be said of a model whose bias is the tolerance with the probability ``error``; ``again``: runs
        that a model was chosen by do not count.
        """
        ...


@dataclass(frozen=True)
class Simplest:
    """The simplest model that is enough.

    Attributes
    ----------
    table
        One row for each simplification alone, then for each combination that was tried, in this order. ``model``,
        ``parts`` (of a combination), ``step`` ("alone", "together"), ``verdict`` ("enough", "not enough", "open", "left
        out"), ``bias``, ``low``, ``high`` (simpler minus full, with the interval that decides), ``runs`` of each,
        ``missing`` runs until it will probably be decided, ``cpu`` and ``work``: CPU time and counted work of a run
        over those of the full model, ``reason`` why it was left out or is not enough.
    answer
        The simplifications that together are enough; empty: none is, and the full model is needed.
    """

    table: pd.DataFrame
    answer: tuple[str, ...]

    @property
    def model(self) -> str:
        """The answer as one name, that of its row."""
        return AND.join(self.answer)

    @property
    def saving(self) -> tuple[float, float]:
        """CPU time and counted work of a run of the full model over those of the answer; 1 without an answer."""
        if not self.answer:
            return 1.0, 1.0
        row = self.table[self.table["model"] == self.model].iloc[-1]
        return 1 / float(row["cpu"]), 1 / float(row["work"])


def compared(model: str, bias: Equivalence | None, *, cpu: float, work: float, runs: int, reason: str = "") -> Row:
    """Return the row of a model; without a bias its runs fail, and it is not enough for this reason."""
    row: Row = {"model": model, "parts": model.count(AND) + 1, "runs": runs, "cpu": cpu, "work": work, "reason": reason}
    if bias is None:
        return {**row, "verdict": "not enough"}
    return {
        **row,
        "verdict": bias.verdict,
        "bias": bias.bias,
        "low": bias.low,
        "high": bias.high,
        "missing": bias.missing,
    }


def search(decider: Decider, kinds: Mapping[str, str], reasons: Mapping[str, str]) -> Simplest:
    """Decide each simplification alone, then combinations, by backward elimination.

    Those that are enough are combined, of each kind the one that costs the least CPU time,
    and of equal ones the least counted work. While the combination is not
    enough, the simplification with the largest bias is dropped. The k-th combination has the error ERROR/2^k, so that
    the answer is wrong with a probability of at most ERROR.

    Parameters
    ----------
    kinds
        The kind of each simplification, of which a combination has one, in the order in which they are named.
    reasons
        Why a simplification is left out, "" for one that is tried.
    """
    with needs("simplify", "report"):
        import pandas as pd
    tried = [name for name in kinds if not reasons[name]]
    rows = [{**row, "step": "alone"} for row in decider.decide(tried, ERROR, again=False)]
    left, error, answer = _cheapest(rows, kinds), ERROR, tuple[str, ...]()
    while left and not answer:
        names, error = tuple(name for name in kinds if name in left), error / 2
        (row,) = decider.decide([AND.join(names)], error, again=True)
        rows.append({**row, "step": "together"})
        if row["verdict"] == "enough":
            answer = names
        else:
            del left[max(left, key=lambda name: left[name])]
    rows += [
        {"model": name, "parts": 1, "step": "alone", "verdict": "left out", "reason": reasons[name]}
        for name in kinds
        if reasons[name]
    ]
    table = pd.DataFrame(rows, columns=COLUMNS).astype({"missing": "Int64", "runs": "Int64"})
    return Simplest(table, answer)


def _cheapest(rows: Iterable[Row], kinds: Mapping[str, str]) -> dict[str, float]:
    """Return the size of the bias of the cheapest simplification of each kind that is enough."""
    enough = sorted((row for row in rows if row["verdict"] == "enough"), key=lambda row: kinds[row["model"]])
    found = {}
    for _, ones in groupby(enough, key=lambda row: kinds[row["model"]]):
        each = list(ones)
        least = min(row["cpu"] for row in each)
        chosen = min((row for row in each if row["cpu"] <= TIE * least), key=lambda row: (row["work"], row["cpu"]))
        found[chosen["model"]] = abs(chosen["bias"])
    return found
