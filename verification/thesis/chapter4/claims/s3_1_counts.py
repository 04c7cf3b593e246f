"""Chapter 4, sections 3.1 and 3.3.3 and footnotes: orders, selections and numbers of runs, counted."""

from __future__ import annotations

from itertools import permutations

from tissue.study.categories import EVENTS
from verification.claims import Comparison, Correction, Effect, Evidence, claim, equal

# The footnote on possible orders: counts as printed, and the orders that it lists.
STEPS = {1: 3, 2: 7, 3: 10, 4: 9}
RIGHT = {1: 3, 2: 7, 3: 12, 4: 12}
LISTED = """A, B, S, AB, AS, BA, BS, BP, SA, SB, ABS, ABP, ASB, BAS, BAP, BSA, BSP, BPA, BPS, SAB, SBA, SBP,
ABSP, ABPS, ASPB, BASP, BAPS, BSAP, BSPA, BPAS, BPSA""".replace("\n", " ").split(", ")
INSTEAD = [*(order for order in LISTED if order != "ASPB"), "ASBP", "SABP", "SBAP", "SBPA"]


def _orders() -> list[str]:
    """All orders of one or more events in which [P] comes after [B]."""
    every = ("".join(order) for k in range(1, 5) for order in permutations(EVENTS, k))
    return [order for order in every if "P" not in order or -1 < order.find("B") < order.find("P")]


@claim(
    "c4.orders",
    "There are 29 orders of one to four events in which [P] follows [B].",
    source="(Q4), footnote 1",
    also=("c4.orders-listed",),
    quote="There are 29 possible orderings of the EMT events … 10× three-step EMT … 9× four-step EMT",
    correction=Correction(
        "34 = 3 + 7 + 12 + 12",
        Effect.NUMBER,
        "the number of EMT categories by order, and the list in the footnote",
        why=(
            "without [P] there are 3, 6 and 6 orders of one to three of A, B, S; with [P] behind [B] 1, 6 and 12 of "
            "two to four: 3, 7, 12 and 12; the footnote itself lists 12 of three"
        ),
        place=2535,
    ),
)
def _count_orders() -> Evidence:
    found = _orders()
    counts = {k: sum(len(order) == k for order in found) for k in STEPS}

    def compare(every: int, by_length: dict[int, int]) -> tuple[Comparison, ...]:
        return (
            equal("orders with [P] after [B]", len(found), every),
            *(equal(f"orders of {k} events", counts[k], wanted) for k, wanted in by_length.items()),
        )

    wrong, lacking = sorted(set(LISTED) - set(found)), sorted(set(found) - set(LISTED))
    return Evidence(
        printed=(
            *compare(29, STEPS),
            equal(f"listed orders with [P] before [B], {', '.join(wrong)}", len(wrong), 0),
            equal(f"possible orders that are not listed, {', '.join(lacking)}", len(lacking), 0),
        ),
        corrected=(
            *compare(34, RIGHT),
            equal("differences from the corrected list", len(set(INSTEAD) ^ set(found)), 0),
        ),
    )
