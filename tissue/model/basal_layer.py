"""The basal layer holds its points (C3), in order (C4), and neighbours at most d^max-basal apart (C2): one sweep.

Of two neighbours of different types it is the mean of both.
"""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.curve import evaluate
from tissue.kernels.lanes import either, fma, load, maximum, spread, store, where_positive
from tissue.kernels.layers import at_ends, move_ends
from tissue.kernels.workspace import Workspace

# Where there is no neighbour.
NOWHERE = 1e300


@inner
def order_basal(work: Workspace, n: int) -> None:
    """0 <= b_{k+1} - b_k (C4) for all neighbours from left to right, then b_{k+1} - b_k <= d^max-basal (C2) likewise.

    Each sweep is a chain in which one correction waits for the one before: the second follows one neighbour behind the
    first, so that both are under way at once. So at each point of the layer the end of the last but one before it is
    known, and kept there, until it is brought back to its own place from right to left. In a ring both ends of the
    layer are neighbours, and come last.
    """
    x, inside_at, ends = work.along, work.held, work.ends
    limit, limit_before = spread(x, 0.0), spread(x, 0.0)  # of the same two
    first, second, joined = spread(x, -NOWHERE), spread(x, NOWHERE), spread(x, 0.0)  # of the two before
    made, corrections = spread(x, 1.0), spread(x, 0.0)
    for i in range(n):
        inside, at = load(inside_at, i), load(x, i)
        push = maximum(fma(0.5, first, -0.5 * at), 0.0)
        ordered = first - push
        pull = maximum(fma(0.5, ordered - second, -0.25 * (limit_before + limit)), 0.0)
        store(ends, i, second + pull)
        corrections = corrections + where_positive(inside * push, made) + where_positive(inside * pull, made)
        first, second = either(inside, at + push, first), either(inside * joined, ordered - pull, second)
        limit_before, limit = either(inside, limit, limit_before), either(inside, load(work.limit, i), limit)
        joined = maximum(inside, joined)
    pull = maximum(fma(0.5, first - second, -0.25 * (limit_before + limit)), 0.0)
    end_before, end = second + pull, first - pull
    for i in range(n - 1, -1, -1):
        inside = load(inside_at, i)
        store(x, i, either(inside, end, load(x, i)))
        end, end_before = either(inside, end_before, end), either(inside, load(ends, i), end_before)
    store(work.counts, 1, load(work.counts, 1) + corrections + where_positive(pull, made))
    if work.curve.ring > 0.0:
        _close(work, n)


@inner
def _close(work: Workspace, n: int) -> None:
    """(C4), then (C2), for the last and the first cell of a ring."""
    first, last = at_ends(work.held, work.along, n)
    limit, limit_before = at_ends(work.held, work.limit, n)
    gap = first + work.curve.ring - last
    push = maximum(-0.5 * gap, 0.0)
    pull = maximum(0.5 * (gap + 2.0 * push - 0.5 * (limit_before + limit)), 0.0)
    move_ends(work.held, work.along, n, push - pull, pull - push)
    made = spread(work.along, 1.0)
    store(work.counts, 1, load(work.counts, 1) + where_positive(push, made) + where_positive(pull, made))


@inner
def lay(work: Workspace, rows: int) -> None:
    """Put the basal points that a bent layer holds where they are along it."""
    for i in range(rows):
        inside = load(work.held, i)
        x, y, along_x, along_y = evaluate(work.curve, load(work.along, i))
        store(work.bx, i, either(inside, x, load(work.bx, i)))
        store(work.by, i, either(inside, y, load(work.by, i)))
        store(work.tangent_x, i, along_x)
        store(work.tangent_y, i, along_y)
