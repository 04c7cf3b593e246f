"""Techniques of proof by programs; each refutes a wrong variant of every statement that it proves.

A statement is given as a function of a factor: 1 makes the statement, another number (-1 where nothing else is said) a
wrong variant, with the opposite sign of a term or with a constant that is too good. Its other arguments become symbols
or variables, by their names.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from inspect import signature
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from verification.claims import FormalProof


class UnsoundProof(Exception):
    """A proof that accepts a wrong variant of its statement, or whose wrong variant it cannot refute."""


@dataclass(frozen=True)
class Step:
    """A proof with its wrong variant, made when it is called.

    Attributes
    ----------
    make
        (statement, wrong variant in words) -> the proof.
    said
        What it proves; empty for what the claim says.
    rejects
        The wrong variant in words; empty for what is printed, or "its wrong variant".
    """

    make: Callable[[str, str], FormalProof]
    said: str = ""
    rejects: str = ""

    def __call__(self, said: str = "", rejects: str = "") -> FormalProof:
        """Return the proof; the words are those of the claim, where the step has none of its own."""
        return self.make(self.said or said, self.rejects or rejects)


def refuse_unless_refuted(refuted: bool, statement: str, wrong: str) -> None:
    """Raise UnsoundProof unless the wrong variant is refuted."""
    if not refuted:
        raise UnsoundProof(f"{statement}: the wrong variant ({wrong}) is not refuted, so the proof says nothing")


def names(function: Callable[..., Any]) -> list[str]:
    """List the arguments of a function after the first one."""
    return list(signature(function).parameters)[1:]
