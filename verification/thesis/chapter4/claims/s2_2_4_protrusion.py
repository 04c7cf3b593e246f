"""Chapter 4, sections 2.1 and 2.2.4: how a basal point runs, and how it pulls its cell."""

from __future__ import annotations

from typing import Any

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument

sp, z3 = library(), solver_library()
t, r, v, turn, d, size, alpha, k = sp.symbols("t r v w d R alpha k", positive=True)

# B = X + (r + v t) e, e a unit vector, X at rest; down = e.y < 0 for a point that begins below its nucleus.
e = sp.Matrix([sp.cos(turn), sp.sin(turn)])
PATH = (r + v * t) * e
x, down, start, speed, time, R, y = reals("x e1 r v t R y")
RUNNING = [start > 0, speed > 0, R > 0, x > 0, time >= 0, y == x + (start + speed * time) * down]
NEVER = z3.Implies(down >= 0, y > -2 * R)


def arrives(when: Any) -> Any:
    """State that the point is at the depth when - v e_y t is this number."""
    return z3.Implies(down < 0, z3.Implies(-speed * down * time == when, y == -2 * R))


_law = argument(
    "c4.protrusion-law",
    "(4.1)",
    "Ḃ_i = v^run (B_i − X_i)/‖B_i − X_i‖ if y(B_i) > −2R^soft, 0 else",
    "A basal point runs away from its nucleus at one speed and stops 2 R_soft below the basal layer; one that begins "
    "above its nucleus never gets there.",
    vanishes(
        [PATH.diff(t) - v * e, PATH.dot(PATH) - (r + v * t) ** 2],
        PATH.diff(t) + v * e,
        "B = X + (r + vt)e, |B − X| = r + vt, solves (4.1) above the depth: one speed, one direction",
        "towards X",
    ),
    follows(
        RUNNING,
        [arrives(x + 2 * R + start * down), NEVER],
        [arrives(-(x + 2 * R + start * down)), NEVER],
        "if e points down, y(B) = −2R^soft at t = (y(X) + 2R^soft + r e_y)/(−v e_y); if not, y(B) ≥ y(X) > −2R^soft "
        "for all t",
        "at the negative of that time",
    ),
    chosen="the nucleus rests; v^run = 1 R_soft/h, for the thesis gives no value",
)


def pull(eta: Any) -> Any:
    """Return the printed force on the nucleus by the basal spring with the rest length eta; d = |X - B|, R = R_soft."""
    return 2 * alpha / (size + eta) * (d - size - eta)


apart, stiff, f = reals("d alpha f")
BELOW = [R > 0, stiff > 0, apart > 0, f * R == 2 * stiff * (apart - R)]
RELAXING = (d - size) * sp.exp(-k * t)

_grip = argument(
    "c4.grip",
    "sections 2.1, 2.2.4",
    "η^bx := ‖X − B‖ − R^soft if y(B) > 0, 0 if y(B) ≤ 0",
    "With this rest length the spring has no force above the basal layer and pulls once below.",
    vanishes(
        pull(d - size),
        pull(d + size),
        "with η^bx = ‖X − B‖ − R^soft, above the layer, the force is 0",
        "with ‖X − B‖ + R^soft",
    ),
    follows(
        [*BELOW, apart > R],
        f > 0,
        (BELOW, f > 0),
        "with η^bx = 0, below it, the force pulls towards B if ‖X − B‖ > R^soft",
        "it pulls at every distance",
    ),
    vanishes(
        pull(RELAXING).subs(t, 0),
        pull(0),
        "with (3.3) and η* = 0 the pull begins with 0 as the point crosses the line",
        "with η = 0 it begins with 0",
    ),
    also=("c4.grip-at-once",),
    correction=Correction(
        (
            "… and pulls once below, as long as ‖X − B‖ > R^soft; a nucleus that is nearer to its basal point is "
            "pushed away"
        ),
        Effect.MODEL,
        (
            "where a nucleus rests beside a basal point below the layer: its disc touches the point, it does not reach"
            " it"
        ),
        why="with η^bx = 0 the printed force is 2α^bx/R^soft (‖B − X‖ − R^soft) towards B: below 0 if ‖B − X‖ < R^soft",
        place=2454,
    ),
)
