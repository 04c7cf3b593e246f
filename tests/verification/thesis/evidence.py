"""The numbers that the checks of all claims find in their tests, kept in evidence.csv.

A verdict leaves room: an ingredient may be wrong and all numbers still in their ranges. After a change that is meant:
``python -m tests.verification.thesis.evidence`` writes the table again, and its difference shows what has changed.
"""

import csv
import math
import re
from functools import cache
from itertools import chain
from pathlib import Path

from tests.verification.thesis.emt_tables import KEPT
from verification.claims import Comparison, Evidence, FormalProof

FILE = Path(__file__).with_name("evidence.csv")
NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")
# Numbers below the second are rounding errors; random numbers, sums and libraries of other processors change less than
# the first.
RELATIVE, ABSOLUTE = 1e-3, 1e-9


def numbers(evidence: Evidence) -> list[str]:
    """List the numbers of the remark, as printed; of the comparisons; and the runs needed."""
    compared = chain.from_iterable(map(of_comparison, (*evidence.printed, *evidence.corrected)))
    found = [*compared, float("nan") if evidence.runs_needed is None else evidence.runs_needed]
    return [*NUMBER.findall(evidence.remark), *(f"{number:.8e}" for number in found)]


def of_comparison(comparison: Comparison | FormalProof) -> list[float]:
    """The value, the ends of its range and of its interval; a proof has none."""
    if isinstance(comparison, FormalProof):
        return []
    return [comparison.value, comparison.low, comparison.high, *(comparison.interval or ())]


def same(found: str, kept: str) -> bool:
    """Whether two numbers are equal, but for rounding and for one unit of the last digit that is printed."""
    a, b = float(found), float(kept)
    if math.isnan(b) or math.isinf(b):
        return repr(a) == repr(b)
    mantissa, _, power = kept.partition("e")
    unit = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2])) if "." in mantissa or power else 0.0
    return abs(a - b) <= max(RELATIVE * abs(b), ABSOLUTE, 1.01 * unit)


@cache
def kept() -> dict[str, list[str]]:
    """The numbers of each claim in the table."""
    with FILE.open(newline="", encoding="utf-8") as lines:
        return {row["id"]: row["numbers"].split() for row in csv.DictReader(lines)}


def differences(name: str, evidence: Evidence) -> list[tuple[str, str]]:
    """The numbers found and kept that differ."""
    found = numbers(evidence)
    if len(found) != len(kept()[name]):
        return [(" ".join(found), " ".join(kept()[name]))]
    return [(a, b) for a, b in zip(found, kept()[name], strict=True) if not same(a, b)]


def main() -> None:
    """Write the table: each claim is decided by the tables that its test gives."""
    from tests.verification.thesis.chapter1 import test_claims as chapter1
    from tests.verification.thesis.chapter2 import test_claims as chapter2
    from tests.verification.thesis.chapter3 import test_claims as chapter3
    from tests.verification.thesis.chapter4 import test_claims as chapter4
    from tests.verification.thesis.chapter5 import test_claims as chapter5

    given = (
        (chapter1, KEPT),
        (chapter2, chapter2.RIGHT),
        (chapter3, chapter3.FOUND),
        (chapter4, KEPT),
        (chapter5, {}),
    )
    with FILE.open("w", newline="", encoding="utf-8") as lines:
        writer = csv.writer(lines, lineterminator="\n")
        writer.writerow(("id", "numbers"))
        for file, tables in given:
            for name, claim in file.CLAIMS.items():
                own = tables.get(name, {}) if file is chapter2 else tables
                if not claim.missing(own):
                    writer.writerow((name, " ".join(numbers(claim.decide(own)))))


if __name__ == "__main__":
    main()
