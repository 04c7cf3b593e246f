"""Chapter 4, sections 3.1 and 3.3.3 and footnotes: orders, selections and numbers of runs, counted."""

from __future__ import annotations

from itertools import permutations, product

from tissue.statistics.categories import EVENTS
from verification.claims import Comparison, Correction, Effect, Evidence, at_least, at_most, claim, equal

# The footnote on possible orders: counts as printed, and the orders that it lists.
STEPS = {1: 3, 2: 7, 3: 10, 4: 9}
RIGHT = {1: 3, 2: 7, 3: 12, 4: 12}
LISTED = """A, B, S, AB, AS, BA, BS, BP, SA, SB, ABS, ABP, ASB, BAS, BAP, BSA, BSP, BPA, BPS, SAB, SBA, SBP,
ABSP, ABPS, ASPB, BASP, BAPS, BSAP, BSPA, BPAS, BPSA""".replace("\n", " ").split(", ")
INSTEAD = [*(order for order in LISTED if order != "ASPB"), "ASBP", "SABP", "SBAP", "SBPA"]
# n^D and n^rep of section 3.3.3, at both ends.
RUNS_PER_CATEGORIES = ((10**4, 10), (5 * 10**5, 500))
# Of Figure 10 and section 4.1.2 [%].
APICAL, BELOW = 30, 60
# Of footnote 2; the ratio of the runtimes 27 s and 0.08 s of chapter 3.
MINUTES, FASTER, MEASURED = 45, 300, 27 / 0.08


@claim(
    "c4.selections",
    "There are twelve sets of events in which [P] comes only with [B].",
    source="(Q2)",
    quote="We get 2³ + 2² = 12 possible selections of active EMT events.",
)
def _selections() -> Evidence:
    chosen = [events for events in product((False, True), repeat=4) if events[1] or not events[3]]
    with_p = sum(events[3] for events in chosen)
    return Evidence(
        printed=(
            equal("selections of A, B, S, P with [P] only beside [B]", len(chosen), 12),
            equal("selections without [P]", len(chosen) - with_p, 2**3),
            equal("selections with [P]", with_p, 2**2),
        ),
    )


def _orders() -> list[str]:
    """All orders of one or more events in which [P] comes after [B]."""
    every = ("".join(order) for k in range(1, 5) for order in permutations(EVENTS, k))
    return [order for order in every if "P" not in order or -1 < order.find("B") < order.find("P")]


@claim(
    "c4.orders",
    "There are 29 orders of one to four events in which [P] follows [B].",
    source="(Q4), footnote 1",
    quote="There are 29 possible orderings of the EMT events … 10× three-step EMT … 9× four-step EMT",
    correction=Correction(
        "34 = 3 + 7 + 12 + 12",
        Effect.NUMBER,
        "the number of EMT categories by order, and the list in the footnote",
        why=(
            "without [P] there are 3, 6 and 6 orders of one to three of A, B, S; with [P] behind [B] 1, 6 and 12 "
            "of two to four: 3, 7, 12 and 12; the footnote itself lists 12 of three"
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

    return Evidence(printed=compare(29, STEPS), corrected=compare(34, RIGHT))


@claim(
    "c4.orders-listed",
    "The footnote lists all possible orders of the events.",
    source="footnote 1",
    quote="9× four-step EMT: ABSP, ABPS, ASPB, BASP, BAPS, BSAP, BSPA, BPAS, BPSA.",
    correction=Correction(
        "without ASPB, with ASBP, SABP, SBAP and SBPA: twelve of four steps",
        Effect.NUMBER,
        "the count of 29 in (Q4)",
        why=(
            "in ASPB [P] comes before [B], which the footnote excludes; of the 4!/2 = 12 orders of all four "
            "events it lacks four"
        ),
        place=2556,
    ),
    rests_on=("c4.orders",),
)
def _listed_orders() -> Evidence:
    found = set(_orders())
    wrong, lacking = sorted(set(LISTED) - found), sorted(found - set(LISTED))
    return Evidence(
        printed=(
            equal(f"listed orders with [P] before [B], {', '.join(wrong)}", len(wrong), 0),
            equal(f"possible orders that are not listed, {', '.join(lacking)}", len(lacking), 0),
        ),
        corrected=(equal("differences from the corrected list", len(set(INSTEAD) ^ found), 0),),
    )


@claim(
    "c4.samples",
    "The numbers of runs and of categories give a thousand runs for each category.",
    source="section 3.3.3",
    quote=(
        "n^D ∈ [10, 500] … n^rep ∈ [10⁴, 5·10⁵] to ensure that we have around 10³ simulations to rate each category"
    ),
    arithmetic=True,
)
def _samples() -> Evidence:
    return Evidence(
        printed=tuple(
            equal(f"runs per category, n^rep = {runs} and n^D = {categories}", runs / categories, 1000)
            for runs, categories in RUNS_PER_CATEGORIES
        )
    )


@claim(
    "c4.ten-per-cent",
    "The shares of Figure 10 and of section 4.1.2 for [A] add up.",
    source="section 4.1.2, Figure 10",
    quote=(
        "There is only a 10 % likelihood that an EMT cell is neither apically extruded nor below all epithelial cells."
    ),
    arithmetic=True,
)
def _ten_per_cent() -> Evidence:
    what = f"100 − {APICAL} (apically extruded) − {BELOW} (below all control cells) [%]"
    return Evidence(printed=(equal(what, 100 - APICAL - BELOW, 10),))


@claim(
    "c4.speed-up",
    "45 min at the new speed are ten days at the former one.",
    source="footnote 2",
    quote="300 times faster … 50000 simulations in less than 45 min instead of 10 days",
    arithmetic=True,
)
def _speed_up() -> Evidence:
    """300 is rounded down: 'over 300 times' in the introduction, 27 s against 0.08 s in chapter 3."""
    low, high = (faster * MINUTES / 60 / 24 for faster in (FASTER, MEASURED))
    return Evidence(
        printed=(
            at_most(f"{FASTER} times {MINUTES} min [days]", low, 10),
            at_least(f"{MEASURED:.0f} times, by the runtimes of chapter 3, {MINUTES} min [days]", high, 10),
        ),
    )
