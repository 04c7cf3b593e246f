"""Chapter 4, sections 2.2.1 to 2.2.3 and 2.2.5: how cells leave the layers, what their springs do, and who divides."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity

# A freed spring at rest, long after the event: its length R + eta less R, eta by (3.2) with eta* = 0, or as it was.
sp = library()
t, k, R, eta = sp.symbols("t k R eta", positive=True)

_rest_length = identity(
    "c4.rest-length",
    "sections 2.2.1, 2.2.2",
    "the INM-specific cell event (3.2) [(3.3)] will not apply anymore for the i th cell",
    "After the loss of adhesion an equation of chapter 3 no longer holds for the rest length.",
    right=sp.limit(eta * sp.exp(-k * t), t, sp.oo),
    wrong=sp.limit(eta, t, sp.oo),
    correction=Correction(
        (
            "the rules of sections 2.2.2 and 2.2.3 of chapter 3 that set η^{ax*} and η^{bx*} do not apply any more; "
            "(3.2) and (3.3), by which η tends to η* = 0, do"
        ),
        Effect.MODEL,
        "events [A] and [B], the contraction in Figures 5 and 6, the pull-in effect of section 4.3.2",
        why=(
            "η tends to η* only by (3.2) and (3.3); if they stop at the time of the event, η stays as it is and "
            "nothing contracts, against Figures 5 and 6"
        ),
        place=2403,
    ),
)
