"""The live chart of speed against accuracy as a reader uses it, and what the instrument says of the same choice."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from verification.instruments.chart import WorkPrecision
from verification.instruments.cheapest import UNDECIDED, costs, rank
from verification.instruments.interactive import DECADES

if TYPE_CHECKING:
    from playwright.sync_api import Page

Listed = list[tuple[float, str, list[str], float]]
ROWS = """() => [...document.querySelectorAll(".live tbody tr")]
    .map(row => [Number(row.dataset.target), row.dataset.word, row.dataset.tied, Number(row.dataset.cost)])"""
# As a reader would, but in one step: a page of many families is asked often.
CHOOSE = """([scene, norm, cost, without]) => {
    const root = document.getElementById("live");
    for (const [name, value] of Object.entries({scene, norm, cost})) root.querySelector(`[name=${name}]`).value = value;
    for (const box of root.querySelectorAll("input")) box.checked = !without.includes(box.value);
    root.querySelector("select").dispatchEvent(new Event("change", {bubbles: true}));
}"""


def choose(page: Page, scene: str, error: str, cost: str, without: Collection[str] = ()) -> None:
    """Choose scene, error and cost, and untick families."""
    page.evaluate(CHOOSE, [scene, error, cost, list(without)])


def listed(page: Page) -> Listed:
    """Return target, word ("" for one method), methods and cost of each row of the page.

    Costs have six digits. Methods are sorted: the order of methods of one cost has no meaning.
    """
    return [(target, word, _ordered(tied), _rounded(cost)) for target, word, tied, cost in page.evaluate(ROWS)]


def cheapest(one: WorkPrecision, error: str, cost: str, without: Collection[str] = ()) -> Listed:
    """Return what the instrument says, as ``listed``."""
    kept = [label for label, look in one.looks.items() if look["family"] not in without]
    found = costs(one.table, DECADES, error, cost)
    limit = one.budget.certain() if cost == one.budget.column else float("inf")
    return [
        (row.target, row.cheapest if row.cheapest in UNDECIDED else "", _ordered(row.tied), _rounded(row.cost))
        for row in rank(found[found["method"].isin(kept)], limit).itertuples()
    ]


def _ordered(methods: str) -> list[str]:
    return sorted(methods.split("; "))


def _rounded(cost: float) -> float:
    return float(f"{0.0 if cost != cost else cost:.6g}")
