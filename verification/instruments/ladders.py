"""The runs of order_study and work_precision: every method, from coarse to fine settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import pandas as pd

from dincl.study import Key, Row, Study
from verification.instruments.budget import Budget
from verification.instruments.error_norms import ErrorAt, Norm, heading
from verification.instruments.measure import measure
from verification.instruments.method import Method
from verification.instruments.references import Known, known_at
from verification.instruments.stored import settings_of


@dataclass(frozen=True, eq=False)
class Ladders:
    """Methods on one problem over ladders of settings; a run is a whole ladder, since a budget ends it.

    Attributes
    ----------
    problem, methods, t, reference, errors, budget
        As ``order_study`` takes them, checked.
    ladders
        Label of a method -> its settings from coarse to fine.
    repeats
        Of brief runs, for their time.
    enough
        The largest error after which nothing finer is tried; None: the budget alone ends a ladder.
    """

    problem: Any
    methods: tuple[Method, ...]
    ladders: Mapping[str, tuple[float, ...]]
    t: Any
    reference: Any
    errors: Mapping[str, Norm]
    budget: Budget | None
    repeats: int
    enough: float | None = None

    @cached_property
    def known(self) -> Known:
        """The reference at the times, computed when the first run needs it, and sent to workers with the runs."""
        known = known_at(self.reference, self.t, problem=self.problem)
        known.take([norm.t for norm in self.errors.values() if isinstance(norm, ErrorAt)])  # raises for another time
        return known

    def __call__(self, key: Key) -> list[Row]:
        """Make the runs of one method; one row for each setting."""
        (method,) = (one for one in self.methods if one.label == key["method"])
        settings = self.ladders[method.label]
        rows = measure(self.problem, method, settings, self.known, self.errors, self.budget, self.repeats, self.enough)
        return [{"method": method.label, "family": method.family} | row for row in rows]

    def study(self, name: str, title: str) -> Study:
        """Return the study of these runs, one for each method, which names its rows by the setting."""
        settings = {one.name: getattr(self, one.name) for one in self.__dataclass_fields__.values()}
        return Study(
            name,
            title,
            ("method",),
            tuple({"method": method.label} for method in self.methods),
            self,
            settings_of(**settings),
            columns={"method": "Method", "setting": "Setting", "status": "Status"}
            | {name: heading(name) for name in self.errors}
            | {"cpu_seconds": "CPU time [s]"},
            by=("setting",),
            prepare=lambda: self.known,
        )

    def sorted(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return rows of the study in the order of the methods, from coarse to fine."""
        places = {method.label: place for place, method in enumerate(self.methods)}
        mine = rows[rows["method"].isin(places)]
        order = mine.assign(_place=mine["method"].map(places), _coarse=-mine["setting"])
        return order.sort_values(["_place", "_coarse"], kind="stable", ignore_index=True)[list(rows.columns)]

    @property
    def looks(self) -> dict[str, dict[str, Any]]:
        """Label -> family and keywords of matplotlib."""
        return {method.label: {"family": method.family} | dict(method.look) for method in self.methods}
