"""Techniques of proof by programs; each refutes a wrong variant of every statement that it proves.

A statement is given as a function of a factor: 1 makes the statement, another number (-1 where nothing else is said) a
wrong variant, with the opposite sign of a term or with a constant that is too good. Its other arguments become symbols
or variables, by their names.
"""

from collections.abc import Callable
from inspect import signature
from typing import Any


class UnsoundProof(Exception):
    """A proof that accepts a wrong variant of its statement, or whose wrong variant it cannot refute."""


def refuse_unless_refuted(refuted: bool, statement: str, wrong: str) -> None:
    """Raise UnsoundProof unless the wrong variant is refuted."""
    if not refuted:
        raise UnsoundProof(f"{statement}: the wrong variant ({wrong}) is not refuted, so the proof says nothing")


def names(function: Callable[..., Any]) -> list[str]:
    """List the arguments of a function after the first one."""
    return list(signature(function).parameters)[1:]
