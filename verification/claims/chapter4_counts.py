"""Chapter 4: what it counts and lists."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from itertools import permutations, product

import numpy as np

from tissue.study.categories import EVENTS
from tissue.study.plan import load_study
from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if

# The footnote on possible orders: counts as printed, and the orders that it lists.
STEPS = {1: 3, 2: 7, 3: 10, 4: 9}
LISTED = """A, B, S, AB, AS, BA, BS, BP, SA, SB, ABS, ABP, ASB, BAS, BAP, BSA, BSP, BPA, BPS, SAB, SBA, SBP,
ABSP, ABPS, ASPB, BASP, BAPS, BSAP, BSPA, BPAS, BPSA""".replace("\n", " ").split(", ")


def _orders() -> list[str]:
    """All orders of one or more events in which [P] comes after [B]."""
    every = ("".join(order) for k in range(1, 5) for order in permutations(EVENTS, k))
    return [order for order in every if "P" not in order or -1 < order.find("B") < order.find("P")]


def _count_orders(_: Tables) -> Verdict:
    found = _orders()
    counts = {k: sum(len(order) == k for order in found) for k in STEPS}
    return corrected_if(
        len(found) == sum(STEPS.values()),
        counts == {1: 3, 2: 7, 3: 12, 4: 12},
        f"{len(found)} orders with [P] after [B], not {sum(STEPS.values())}: {counts[3]} of three steps, as many as "
        f"the footnote lists under 'ten', and {counts[4]} of four",
    )


def _listed_orders(_: Tables) -> Verdict:
    found = set(_orders())
    wrong, lacking = sorted(set(LISTED) - found), sorted(found - set(LISTED))
    return corrected_if(
        not wrong and not lacking,
        wrong == ["ASPB"] and lacking == ["ASBP", "SABP", "SBAP", "SBPA"],
        f"listed though [P] comes before [B]: {', '.join(wrong)}; not listed: {', '.join(lacking)}",
    )


def _selections(_: Tables) -> Verdict:
    chosen = [events for events in product((False, True), repeat=4) if events[1] or not events[3]]
    return holds_if(len(chosen) == 2**3 + 2**2, f"{len(chosen)} selections of A, B, S, P with [P] only beside [B]")


def _seven_per_cent(_: Tables) -> Verdict:
    """The part of the cells with [P] in effect: both drawn, independently."""
    effective = [round(100 * 0.7 * p) for p in (0.9, 0.5, 0.1)]
    return corrected_if(
        effective == [63, 35, 6],
        effective == [63, 35, 7],
        f"90 %, 50 % and 10 % of the 70 % with [B] are {', '.join(map(str, effective))} %",
    )


def _data_points(_: Tables) -> Verdict:
    points = 50_000 * 10
    return corrected_if(points == 5e6, points == 5e5, f"50,000 runs of 10 cells are {points:.0e} cells, a tenth of it")


def _table4(_: Tables) -> Verdict:
    """Rows as (T_A, T_B, T_P) [h], in the order of the table; the ninth is called by [B], after the two with [A]."""
    never = np.inf
    printed = [
        (6, 12, 18),
        (12, 6, 18),
        (never, 6, 6),
        (never, 6, 18),
        (6, 18, never),
        (18, 6, never),
        (6, never, never),
        (18, never, never),
        (6, never, never),
        (never, 18, never),
        (never, never, never),
    ]
    right = [*printed[:8], (never, 6, never), *printed[9:]]
    scenarios = load_study("figure15").scenarios
    return corrected_if(
        len(set(printed)) == len(printed),
        len(set(right)) == len(right) and 4 * len(right) == len(scenarios),
        "rows 7 and 9 have the same times, T_A = 6 h alone: of 11 programs two would be one; with T_B = 6 h row 9 is "
        "the partner of row 10, and all differ",
    )


def _figure_20(_: Tables) -> Verdict:
    """Which events have times in the populations of Table 5."""
    parameters = load_study("table5_35").scenarios["35 % [P]"]
    random = {event for event in EVENTS if getattr(parameters.emt, event.lower()).ever}
    return corrected_if(
        random >= {"A", "B", "S"},
        random == {"A", "B", "P"},
        f"T_S = inf in all of Table 5: there are times of {', '.join(sorted(random))} only, as the text has it",
    )


def _ten_per_cent(_: Tables) -> Verdict:
    neither = 100 - 30 - 60
    return holds_if(neither == 10, f"100 - 30 (apical) - 60 (below all control cells) = {neither} %")


CLAIMS = (
    Claim(
        "c4.orders",
        "Section 3.1 of chapter 4, (Q4)",
        "There are 29 possible orderings of the EMT events.",
        _count_orders,
    ),
    Claim(
        "c4.orders-listed",
        "Footnote 1 of chapter 4",
        "9× four-step EMT: ABSP, ABPS, ASPB, BASP, BAPS, BSAP, BSPA, BPAS, BPSA.",
        _listed_orders,
    ),
    Claim(
        "c4.selections",
        "Section 3.1 of chapter 4, (Q2)",
        "We get 2^3 + 2^2 = 12 possible selections of active EMT events.",
        _selections,
    ),
    Claim("c4.table-4", "Table 4 of chapter 4", "☒: T^P = ∞, T^A = 6 h, T^B = ∞, T^S = ∞.", _table4),
    Claim("c4.seven-per-cent", "Table 5 of chapter 4", "'6% [P]': U^{10%}(6 h, 24 h).", _seven_per_cent),
    Claim(
        "c4.data-points",
        "Section 4.5 of chapter 4",
        "50000 simulation runs with 10 EMT cells each, yielding 5×10^6 data points.",
        _data_points,
    ),
    Claim("c4.figure-20", "Figure 20", "Extrusion ratios for cells which start of [A], [B] and [S].", _figure_20),
    Claim(
        "c4.ten-per-cent",
        "Section 4.1.2 of chapter 4",
        "There is only a 10 % likelihood that an EMT cell is neither apically extruded nor below all epithelial cells.",
        _ten_per_cent,
    ),
)
