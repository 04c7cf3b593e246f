"""What an event of the epithelial-to-mesenchymal transition is: a name, and what it does to a cell."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from types import FunctionType

from dincl.checks import instance, string
from dincl.errors import InvalidProblem

_NAME = re.compile("[a-z][a-z0-9]*")


@dataclass(frozen=True)
class EmtEvent:
    """An event that begins once in a cell, at a time that the parameters give.

    It fires in the step dt that ends at its time, or in which its time lies, and acts from the beginning of that step.
    Its functions are plain Python at top level of a file; numba compiles them, alone, when a run first needs them, and
    any function that they call must be one of ``dincl.compiled.inner``. They change the store in place.

    Attributes
    ----------
    name
        Its key in the section [emt] of parameter files: lower-case letters and digits. Tables have ``mark``, and the
        column ``t_NAME_h``.
    meaning, source
        One line each: what happens, and who says so.
    begin
        ``begin(store, i, bit, numbers)``, called once, for cell i; ``numbers`` are those of its type. ``bit``: that of
        this event, as in ``store.cells.events``, which does not have it yet; ``store.emt.new`` has the bits of all
        events that begin in the same step. None: nothing happens at once.
    last
        ``last(store, i, rest_ax, rest_bx, numbers)``, called for each dt from then on, after the rest lengths of the
        springs have relaxed as in other cells; given are those before. The events of this package are called first,
        then others by name.
    after
        The name of an event that this one waits for, so that it begins at the later time of both.

    Raises
    ------
    InvalidProblem
        If the name is none, there is nothing to do, or ``begin`` or ``last`` is no function.
    """

    name: str
    meaning: str
    source: str
    begin: Callable[..., None] | None = None
    last: Callable[..., None] | None = None
    after: str | None = None

    def __post_init__(self) -> None:
        string("name", self.name, _NAME, "lower-case letters and digits")
        string("meaning", self.meaning)
        string("source", self.source)
        if self.after is not None:
            string(f"EmtEvent {self.name}: after", self.after)
        for key, value in (("begin", self.begin), ("last", self.last)):
            if value is not None:
                instance(f"EmtEvent {self.name}: {key}", value, FunctionType, "a function, or None")
        if self.begin is None and self.last is None:
            raise InvalidProblem(f"EmtEvent {self.name}: must have a function begin, last, or both")

    @property
    def mark(self) -> str:
        """How tables write it: "A" for "a", "Squeeze" for "squeeze"; marks that are put together can be told apart."""
        return self.name.capitalize()
