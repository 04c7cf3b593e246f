"""Claims: a sentence, the check that decides it, and the correction where the sentence is wrong."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from enum import Enum
from inspect import signature
from pkgutil import resolve_name
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.extras import MissingLibrary
from verification.claims.evidence import Evidence, Verdict

if TYPE_CHECKING:
    import pandas as pd

# By name.
Tables = Mapping[str, "pd.DataFrame"]


class Table(str):
    """The name of a table that checks read, with the function that makes it.

    Attributes
    ----------
    made_by
        "module:function" of a function of a context, which fills ``context.tables``; imported when it is needed.
    """

    made_by: str

    def __new__(cls, name: str, made_by: str) -> Table:
        table = super().__new__(cls, name)
        table.made_by = made_by
        return table


class MissingRow(RuntimeError):
    """A table has no row of the kind that a check is about: the studies were too short for it."""


class Effect(Enum):
    """What a correction changes; the most serious first."""

    CONCLUSION = "a conclusion"
    MODEL = "the model or method"
    NUMBER = "a number"
    PROOF = "a step of a proof"
    NOTATION = "notation only"


@dataclass(frozen=True)
class Correction:
    """What to read instead of a statement that is wrong as printed.

    Attributes
    ----------
    text
        The statement as it holds.
    effect
        What changes for a reader who takes the correction.
    depends
        What else rests on the statement: equations, algorithms, figures, conclusions.
    why
        The reason, in one or two sentences: the derivation, or the other place that says otherwise.
    place
        Where it stands in the source, a number that only sorts: of the thesis the line in its text.
    """

    text: str
    effect: Effect
    depends: str
    _: KW_ONLY
    why: str = ""
    place: int = 0


@dataclass(frozen=True)
class Claim:
    """One claim.

    Attributes
    ----------
    id
        Unique short name, without spaces.
    statement
        The claim in our own words.
    check
        Function that decides it: () -> Evidence, or tables -> Evidence where ``needs`` names some.
    source
        Place of the claim in its source.
    quote
        One sentence or formula of the source, as printed.
    needs
        Names of the tables that ``check`` reads; a ``Table`` says what makes it.
    rests_on
        Ids of the claims that this one uses; where one of them is corrected or refuted, this one is marked.
    also
        Ids of statements that this one contains: the source says them at several places, and one check decides them.
    recorded
        The verdict that was found; another one is a regression.
    correction
        Where the claim is wrong as printed.
    chosen
        Choices of the check where the source leaves something open.
    tried_on
        The cases that the check decides, where the claim is about more cases: the verdict is then at best "not
        refuted", or "proved for an instance" if the cases are proved. Empty where the check decides the whole claim.
    stated_at
        Module and line of the claim, "module:12"; by default those of its check.

    Raises
    ------
    InvalidProblem
        If a field is not of its kind, if ``check`` takes other arguments, if a verdict after a correction is
        recorded without one, or "holds" with one, or if a verdict on examples does not go with ``tried_on``.
    """

    id: str
    statement: str
    check: Callable[..., Evidence]
    _: KW_ONLY
    source: str = ""
    quote: str = ""
    also: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    rests_on: tuple[str, ...] = ()
    recorded: Verdict = Verdict.HOLDS
    correction: Correction | None = None
    chosen: str = ""
    tried_on: str = ""
    stated_at: str = ""

    def __post_init__(self) -> None:
        if not self.stated_at and isinstance(self.check, FunctionType):
            line = f"{self.check.__module__}:{self.check.__code__.co_firstlineno}"
            object.__setattr__(self, "stated_at", line)
        if not isinstance(self.id, str) or not self.id or self.id != "".join(self.id.split()):
            raise InvalidProblem(f"id = {describe(self.id)}: must be a short name without spaces")
        for name in ("statement", "source", "quote", "chosen", "tried_on"):
            self._refuse_unless(name, isinstance(getattr(self, name), str), "text")
        self._refuse_unless("statement", bool(self.statement.strip()), "a sentence")
        tuples = {"needs": "names of tables", "rests_on": "ids of other claims", "also": "ids of other statements"}
        for name, allowed in tuples.items():
            given = getattr(self, name)
            named = isinstance(given, tuple) and all(isinstance(each, str) and each for each in given)
            self._refuse_unless(name, named and self.id not in given, f"a tuple of {allowed}")
        self._refuse_unless("recorded", isinstance(self.recorded, Verdict), f"one of {', '.join(map(str, Verdict))}")
        self._refuse_unless(
            "correction", self.correction is None or isinstance(self.correction, Correction), "a Correction or None"
        )
        self._check_recorded()
        arguments = len(signature(self.check).parameters) if callable(self.check) else -1
        allowed = "a function of the tables" if self.needs else "a function without arguments, as it needs no table"
        self._refuse_unless("check", arguments == bool(self.needs), allowed)

    def _check_recorded(self) -> None:
        """Refuse a recorded verdict that the claim cannot have."""
        true = tuple(map(self._restricted, (Verdict.PROVED, Verdict.HOLDS)))
        fitting = (Verdict.CORRECTED, Verdict.REFUTED) if self.correction else (*true, Verdict.REFUTED, Verdict.OPEN)
        given = (f"{'with' if self.correction else 'without'} a correction", "of examples" if self.tried_on else "")
        allowed = f"one of {', '.join(map(str, fitting))} {' '.join(filter(None, given))}"
        self._refuse_unless("recorded", self.recorded in fitting, allowed)

    def _refuse_unless(self, name: str, right: bool, allowed: str) -> None:
        if not right:
            raise InvalidProblem(f"claim {self.id}: {name} = {describe(getattr(self, name))}: must be {allowed}")

    def __reduce__(self) -> tuple[Callable[[str, str], Claim], tuple[str, str]]:
        """Pickle a claim by its module and its id."""
        return find, (self.module, self.id)

    @property
    def module(self) -> str:
        """The module that states the claim."""
        return self.stated_at.rpartition(":")[0]

    def missing(self, tables: Tables) -> list[str]:
        """Return the names of the tables that the check reads and that are missing."""
        return [name for name in self.needs if name not in tables]

    def decide(self, tables: Tables) -> Evidence:
        """Run the check; open where a table or a library that the check needs is missing."""
        missing = self.missing(tables)
        if missing:
            return Evidence(f"the table {', '.join(missing)} is not there", ())
        try:
            return self.check(tables) if self.needs else self.check()
        except MissingLibrary as library:
            return Evidence(str(library), ())

    def verdict(self, evidence: Evidence) -> Verdict:
        """Return the verdict on the claim: examples that agree do not show that a general claim holds."""
        return self._restricted(evidence.verdict)

    def _restricted(self, verdict: Verdict) -> Verdict:
        """Return the verdict on the claim for a verdict on the cases of its check."""
        of_examples = {Verdict.HOLDS: Verdict.NOT_REFUTED, Verdict.PROVED: Verdict.PROVED_INSTANCE}
        return of_examples.get(verdict, verdict) if self.tried_on else verdict


def claim(id: str, statement: str, **details: Any) -> Callable[[Callable[..., Evidence]], Claim]:
    """State what a check decides, above the check.

    ``@claim("my.order", "PBD converges with order one on my scene")`` above a function () -> Evidence gives a Claim.
    With ``needs``, the names of tables, the function is tables -> Evidence. ``details`` and errors: see ``Claim``. A
    claim with a correction is recorded as corrected, one on examples as not refuted, unless something else is said.
    """
    if details.get("correction"):
        details.setdefault("recorded", Verdict.CORRECTED)
    elif details.get("tried_on"):
        details.setdefault("recorded", Verdict.NOT_REFUTED)

    def stated(check: Callable[..., Evidence]) -> Claim:
        """Return the claim that the function decides."""
        return Claim(id, statement, check, **details)

    return stated


def stated_in(module: ModuleType) -> tuple[Claim, ...]:
    """Return the claims of a module in order of definition: its attributes that are claims, or tuples of claims.

    Claims that it imports from another module are that one's.
    """
    found: dict[int, Claim] = {}
    for value in vars(module).values():
        for each in value if isinstance(value, tuple) else (value,):
            if isinstance(each, Claim) and each.module == module.__name__:
                found[id(each)] = each
    return tuple(found.values())


def find(module: str, name: str) -> Claim:
    """Return the claim of a module by its id; ``import_module`` would make each check depend on the whole package."""
    return next(each for each in stated_in(resolve_name(module)) if each.id == name)
