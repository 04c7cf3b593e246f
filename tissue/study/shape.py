"""The keys of a study file and what each may be, as ``tissue.files.fields`` does it for parameter files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, Protocol, TypeGuard
from urllib.parse import quote

from dincl.checks import describe
from tissue.files.fields import count
from tissue.files.messages import unknown

MOST_REPLICATES = 10_000_000
# Bytes of the name of a folder, of which "scenario=" is part, that file systems take.
LONGEST_NAME = 255 - len("scenario=")


class KeyCheck(Protocol):
    """Returns a value that is allowed, raises ValueError for another."""

    @property
    def allowed(self) -> str:
        """The values that are allowed, in words."""

    def __call__(self, raw: Any) -> Any: ...


@dataclass(frozen=True)
class OneLine:
    """One line that says something."""

    allowed: str = "a text of one line"

    def __call__(self, raw: Any) -> str:
        if not isinstance(raw, str) or not raw.strip() or not raw.isprintable():
            raise ValueError(f"must be {self.allowed}")
        return raw


@dataclass(frozen=True)
class ReplicateNumbers:
    """Replicates, each once."""

    allowed: str = "a list of different replicates, which count from 0"

    def __call__(self, raw: Any) -> tuple[int, ...]:
        one = count(MOST_REPLICATES - 1, least=0)
        try:
            numbers = tuple(one(item) for item in raw) if isinstance(raw, list) else None
        except ValueError:
            numbers = None
        if numbers is None or len(set(numbers)) < len(numbers):
            raise ValueError(f"must be {self.allowed}")
        return tuple(sorted(numbers))


@dataclass(frozen=True)
class Tables:
    """Tables of tables: parameters by section, or scenarios by name."""

    allowed: str
    least: int = 0

    def __call__(self, raw: Any) -> dict[str, dict[str, Any]]:
        if not _is_of_tables(raw) or len(raw) < self.least:
            raise ValueError(f"must be {self.allowed}")
        for name in raw:
            if not name or not name.isprintable() or len(quote(name, safe="")) > LONGEST_NAME:
                raise ValueError(f"must be {self.allowed}; {describe(name)} is too long, empty or not printable")
        return raw


@dataclass(frozen=True)
class CompareTable:
    """One table, whose keys are checked where the scenarios are known."""

    allowed: str

    def __call__(self, raw: Any) -> dict[str, Any]:
        if not isinstance(raw, dict) or not raw:
            raise ValueError(f"must be {self.allowed}")
        return raw


def _is_of_tables(raw: Any) -> TypeGuard[dict[str, dict[str, Any]]]:
    return isinstance(raw, dict) and all(isinstance(table, dict) for table in raw.values())


@dataclass(frozen=True)
class FactorTables:
    """Factors: tables of levels, which are sections of parameters."""

    allowed: str = 'tables of two levels or more, such as [factors.time], early = { emt.ac = "6 h" }'

    def __call__(self, raw: Any) -> dict[str, dict[str, Any]]:
        levels: list[dict[str, Any]] = list(raw.values()) if _is_of_tables(raw) else []
        if not levels or not all(len(one) > 1 and _is_of_tables(one) for one in levels):
            raise ValueError(f"must be {self.allowed}")
        names = [", ".join(each) for each in product(*levels)]
        if len(set(names)) < len(names):
            raise ValueError(f"must be {self.allowed}, with names that make different scenarios")
        Tables("levels whose names make those of scenarios")({name: {} for name in names})
        return dict(raw)


SHAPE: dict[str, KeyCheck] = {
    "title": OneLine(),
    "base": OneLine("a preset or the path of a parameter file, relative to this one"),
    "replicates": count(MOST_REPLICATES),
    "seed": count(2**63 - 1, least=0),
    "trajectories": ReplicateNumbers(),
    "overrides": Tables("sections of parameters, such as [overrides.numerics]"),
    "scenarios": Tables('at least one table, such as [scenarios."[A]"], of sections of parameters', least=1),
    "factors": FactorTables(),
    "compare": CompareTable("a table: outcomes, and the factor effect, or contrasts"),
    "simplify": CompareTable("a table: outcome, scenarios, tolerance, at, runs"),  # see tissue.study.simplify
}
OPTIONAL: dict[str, Any] = {"trajectories": (), "overrides": {}, "factors": {}, "compare": None, "simplify": None}


def _unknown(key: str, value: Any) -> str:
    if key == "own":
        return f"own = {describe(value)}: put own.modules into the base, or under [overrides.own]"
    return unknown(key, value, SHAPE)


def checked(tables: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """KeyCheck a study file: its good values by key, and a line for each bad, missing and unknown one."""
    good = dict(OPTIONAL)
    lines = [_unknown(key, value) for key, value in tables.items() if key not in SHAPE]
    for key, check in SHAPE.items():
        if key in tables:
            try:
                good[key] = check(tables[key])
            except ValueError as error:
                lines.append(f"{key} = {describe(tables[key])}: {error}")
        elif key == "scenarios" and "factors" in tables:
            good[key] = {}
        elif key not in OPTIONAL:
            lines.append(f"{key} is missing: must be {check.allowed}")
    replicates = good.get("replicates", MOST_REPLICATES)
    if any(number >= replicates for number in good["trajectories"]):
        lines.append(f"trajectories = {describe(list(good['trajectories']))}: must be below replicates = {replicates}")
    return good, lines
