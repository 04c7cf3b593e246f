"""Evidence: numbers beside the ranges that a claim requires, proofs, and the verdict that follows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

Interval = tuple[float, float]


class Verdict(Enum):
    """The result of a check of a claim."""

    PROVED = "proved"
    PROVED_INSTANCE = "proved for an instance"
    HOLDS = "holds"
    NOT_REFUTED = "not refuted"
    CORRECTED = "refuted, holds when corrected"
    REFUTED = "refuted"
    OPEN = "open"


@dataclass(frozen=True)
class Comparison:
    """A measured number and the range that a claim requires.

    Attributes
    ----------
    what
        Name of the quantity, with its unit in brackets.
    value
        The number; NaN where nothing could be measured.
    low, high
        Ends of the required range, tolerance included.
    interval
        Interval of the true value, where ``value`` is an estimate.
    """

    what: str
    value: float
    low: float
    high: float
    interval: Interval | None = None

    @property
    def true(self) -> bool | None:
        """Whether the number is in the range; None if it is NaN or its interval reaches over an end of the range."""
        least, most = self.interval or (self.value, self.value)
        if math.isnan(self.value) or math.isnan(least) or math.isnan(most):
            return None
        if self.low <= least and most <= self.high:
            return True
        return False if most < self.low or self.high < least else None

    def __str__(self) -> str:
        """Return the quantity with its value and interval, and the required range, in one line."""
        found = f"{self.what}: {self.value:.4g}"
        if self.interval is not None:
            found += f" [{self.interval[0]:.4g}, {self.interval[1]:.4g}]"
        return f"{found} (required {self._range()})"

    def _range(self) -> str:
        if self.low == self.high:
            return f"{self.low:.6g}"
        if math.isinf(self.low):
            return f"≤ {self.high:.4g}"
        if math.isinf(self.high):
            return f"≥ {self.low:.4g}"
        middle = (self.low + self.high) / 2
        return f"{middle:.6g} ± {self.high - middle:.2g}"


def equal(
    what: str, value: float, expected: float, tolerance: float = 0.0, interval: Interval | None = None
) -> Comparison:
    """Require |value - expected| <= tolerance."""
    return Comparison(what, float(value), expected - tolerance, expected + tolerance, interval)


def at_most(
    what: str, value: float, bound: float, tolerance: float = 0.0, interval: Interval | None = None
) -> Comparison:
    """Require value <= bound + tolerance."""
    return Comparison(what, float(value), -math.inf, bound + tolerance, interval)


def at_least(
    what: str, value: float, bound: float, tolerance: float = 0.0, interval: Interval | None = None
) -> Comparison:
    """Require value >= bound - tolerance."""
    return Comparison(what, float(value), bound - tolerance, math.inf, interval)


class Technique(Enum):
    """How a statement is proved."""

    IDENTITY = "computer algebra"
    SQUARES = "a sum of squares"
    REALS = "a decision procedure for real numbers"


@dataclass(frozen=True)
class FormalProof:
    """Proof of a statement by a program, with a wrong variant that the same program rejects.

    Attributes
    ----------
    statement
        What is proved.
    technique
        See ``Technique``.
    tool
        The programs that accept it, with their versions.
    true
        Whether it is proved: False if it is refuted, None if the program comes to no decision.
    rejected
        The wrong variant of the statement that the same technique refutes; empty for a refuted statement.
    certificate
        What a reader can check without the program; empty where there is nothing.
    given
        What the program decided, where it is short: assumptions ⊢ conclusions.
    """

    statement: str
    technique: Technique
    tool: str
    true: bool | None
    rejected: str
    certificate: str = ""
    given: str = ""

    def __str__(self) -> str:
        """Return statement, technique and tool, what was decided, certificate and rejected variant, in one line."""
        found = {True: "proved", False: "refuted", None: "not decided"}[self.true]
        parts = (
            f", certificate: {self.certificate}" if self.certificate else "",
            f": {self.given}" if self.given else "",
        )
        rejected = f"; {self.rejected}: refuted" if self.rejected else ""
        return f"{self.statement}: {found} by {self.technique.value} ({self.tool}{parts[0]}{parts[1]}){rejected}"


@dataclass(frozen=True)
class Evidence:
    """Result of a check.

    Attributes
    ----------
    remark
        A sentence that says more than the comparisons do; mostly empty.
    printed
        Comparisons and proofs that all hold if the claim does as printed; none: nothing could be measured.
    corrected
        Comparisons and proofs that all hold if the claim does after its correction.
    seed
        Of the random numbers, where there are any.
    runs_needed
        Of a claim about frequencies or means: number of simulations that would show a difference of the size that was
        measured (or stated).
    readings
        Where the source can be read in several ways: the same comparisons under each reading, by its name. The other
        fields are those of the reading that decides.
    """

    remark: str = ""
    printed: tuple[Comparison | FormalProof, ...] = ()
    corrected: tuple[Comparison | FormalProof, ...] = ()
    seed: int | None = None
    runs_needed: int | None = None
    readings: Mapping[str, Evidence] = field(default_factory=dict)

    @property
    def verdict(self) -> Verdict:
        """The verdict on the cases of the check; of a claim that was tried on examples see ``Claim.verdict``."""
        printed, corrected = every(self.printed), every(self.corrected)
        if printed is None:
            return Verdict.OPEN
        if printed:
            return Verdict.PROVED if all(isinstance(each, FormalProof) for each in self.printed) else Verdict.HOLDS
        if not self.corrected:
            return Verdict.REFUTED
        if corrected is None:
            return Verdict.OPEN
        return Verdict.CORRECTED if corrected else Verdict.REFUTED

    @property
    def measured(self) -> str:
        """The remark, or else the comparisons in words."""
        if self.remark:
            return self.remark
        groups = (("as printed", self.printed), ("corrected", self.corrected))
        parts = [f"{name}: {'; '.join(map(str, found))}" for name, found in groups if found]
        return f"{'. '.join(parts)}." if self.corrected else "; ".join(map(str, self.printed))


def proved(*proofs: FormalProof) -> Evidence:
    """Return proofs of a claim as its evidence; the remark names what they prove."""
    found = "Proved" if every(proofs) else "Not proved"
    return Evidence(f"{found}: {'; '.join(proof.statement for proof in proofs)}.", proofs)


def put_right(*proofs: FormalProof) -> Evidence:
    """Return proofs of a correction whose wrong variants are what is printed."""
    printed = tuple(
        replace(proof, statement=proof.rejected, true=False, rejected="", certificate="", given="") for proof in proofs
    )
    found = "Proved" if every(proofs) else "Not proved"
    said = f"Refuted as printed, {'; '.join(proof.rejected for proof in proofs)}. {found}: "
    return Evidence(f"{said}{'; '.join(proof.statement for proof in proofs)}.", printed, proofs)


def every(comparisons: Sequence[Comparison | FormalProof]) -> bool | None:
    """Return whether all are true; False if one is false, else None if one is open or there are none."""
    truths = [comparison.true for comparison in comparisons]
    if False in truths:
        return False
    return None if None in truths or not truths else True
