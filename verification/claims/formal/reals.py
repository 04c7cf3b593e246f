"""Proofs by decision procedures for real numbers: z3 decides, cvc5 decides again where it can."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial
from typing import Any

from dincl.extras import needs
from verification.claims import FormalProof, Technique
from verification.claims.formal import Step, UnsoundProof, refuse_unless_refuted

# Steps of z3 and of cvc5 for each decision: counted, so that the outcome does not depend on the load of the machine.
LIMIT, SECOND_LIMIT = 20_000_000, 20_000


def solver_library() -> Any:
    """Return z3; MissingLibrary says that a proof needs it."""
    with needs("a proof by a decision procedure", "proofs"):
        import z3
    return z3


def follows(given: Sequence[Any], then: Any, wrong: Any, said: str = "", rejects: str = "") -> Step:
    """Return the proof that a conclusion follows from assumptions about real numbers, see ``reals``.

    Parameters
    ----------
    given, then
        Assumptions; the conclusion, or a list of several. The assumptions and the negated conclusion have no solution.
    wrong
        Another conclusion, which does not follow, or a pair of other assumptions and their conclusion.
    said, rejects
        See ``Step``.
    """
    other = wrong if isinstance(wrong, tuple) else (given, wrong)
    return Step(partial(_implication, (given, then), other), said, rejects)


def reals(names: str) -> Any:
    """Return variables for real numbers; ``names`` are separated by spaces."""
    return solver_library().Reals(names)


def _implication(right: tuple[Any, Any], other: tuple[Any, Any], statement: str, wrong: str) -> FormalProof:
    z3 = solver_library()
    solver = _solver(*right)
    true = {"unsat": True, "sat": False}.get(str(solver.check()))
    counterexample = _solver(*other).check()
    refuse_unless_refuted(counterexample == z3.sat, statement, wrong)
    tool = f"z3 {z3.get_version_string()}"
    if true and _also_unsatisfiable(solver.to_smt2()):
        tool += f", cvc5 {_second().__version__}"
    return FormalProof(statement, Technique.REALS, tool, true, wrong, given=_written(*right))


def _written(assumptions: Sequence[Any], conclusion: Any) -> str:
    """Return assumptions and conclusions in one line."""
    both = (assumptions, _listed(conclusion))
    left, right = (" and ".join(" ".join(str(part).split()) for part in parts) for parts in both)
    return re.sub(r"(?<![\w.*])1\*(?!\*)|(?<!\*)\*1(?![\w.])", "", f"{left} ⊢ {right}".strip())


def _listed(conclusion: Any) -> list[Any]:
    """Return conclusions as a list."""
    return conclusion if isinstance(conclusion, list) else [conclusion]


def _solver(assumptions: Sequence[Any], conclusion: Any) -> Any:
    """Return a solver that looks for a counterexample; UnsoundProof if the assumptions are contradictory or trivial."""
    z3 = solver_library()
    if _limited(assumptions).check() == z3.unsat:
        raise UnsoundProof(f"{assumptions}: the assumptions contradict each other, so anything would follow")
    if all(any(map(each.eq, assumptions)) for each in _listed(conclusion)):
        raise UnsoundProof(f"{conclusion}: nothing follows but what is assumed")
    return _limited([*assumptions, z3.Not(z3.And(conclusion))])


def _limited(conditions: Sequence[Any]) -> Any:
    """Return a solver with a limit of its steps."""
    solver = solver_library().Solver()
    solver.set("rlimit", LIMIT)
    solver.add(*conditions)
    return solver


def _second() -> Any:
    """Import cvc5."""
    with needs("a second decision procedure", "proofs"):
        import cvc5
    return cvc5


def _also_unsatisfiable(text: str) -> bool:
    """Return whether cvc5 finds no solution of a problem in SMT-LIB; False if it does not decide in its steps."""
    cvc5 = _second()
    solver = cvc5.Solver()
    solver.setOption("rlimit-per", str(SECOND_LIMIT))
    parser = cvc5.InputParser(solver)
    parser.setStringInput(cvc5.InputLanguage.SMT_LIB_2_6, f"(set-logic ALL)\n{text}", "problem")
    symbols, answer = parser.getSymbolManager(), ""
    while not (command := parser.nextCommand()).isNull():
        answer += command.invoke(solver, symbols)
    return answer.strip() == "unsat"
