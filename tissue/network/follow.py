"""The network follows its points: edges that a vertex has crossed are flipped, so all triangles turn left again."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.network.carry import carry
from tissue.network.chart import chart_of, middle_of_patch, on_the_way, period_u, period_v, place_of, put, turn
from tissue.network.exchange import IN_CHART, exchange
from tissue.network.halfedges import around, following, is_row, preceding
from tissue.state.cells import Floats
from tissue.state.network import GHOSTS, Network, Place
from tissue.state.surface import SPHERE, Surface, nearest_image

# What ``follow`` returns in place of the work: points coincide, or there is no way for one past the others.
STUCK = -1
# Vertices that do not get through are tried again, by half of the way and around, when the others have moved.
ROUNDS = 24
# Times that some do not get through even so, and the way is cut in half.
FAILURES = 16
# Times that all are moved, at most: enough for a way of hundreds of edges.
PASSES = 4096
# Where more than one of so many would have to move one by one, all move half of the way first; ...
FEW = 4
# ... but not less than this part of it.
SHORTEST = 1.0 / 256.0


@kernel
def follow(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, rule: int) -> int:
    """Bring the network to the points p; all its triangles turn left in the chart before and after.

    The points that can be put in their new places at once are. The others, near an edge that a point has crossed, move
    one by one along straight lines in the chart, in the order of their numbers; see ``carry``. A long way is made in
    parts, between which edges become the other diagonal if that is shorter in the chart.

    Edges must remain shorter than half of a period, and a patch must leave half of a cylinder empty: a triangle that
    goes further around turns left with nobody. A row of cells keeps its order wherever the points go, as in the plane.

    Parameters
    ----------
    px, py, pz
        Of all cells; only those in the network matter.
    rule
        Of the rest lengths of new junctions: PRESENT or MEAN.

    Returns
    -------
    int
        The work: how many vertices were moved one by one, with all attempts, and how many edges they flipped. STUCK
        if the points coincide or cannot be reached: the network is right then, but short of them. Likewise if a point
        is no number, or in the middle of a surface that bends, before anything is changed.
    """
    if not _aim(surface, network, px, py, pz):
        return STUCK
    _come_near(surface, network)
    if is_row(network):
        return _put_row(network)
    work, part, failures = 0, 1.0, 0
    for _ in range(PASSES):
        alone = _put_all(surface, network, part)
        if alone * FEW > network.triangles[0] // 2 + 8 * FEW and part > SHORTEST:
            _put_back(network)
            part *= 0.5
            continue
        left, done = _move_alone(surface, network, px, py, pz, rule, part) if alone > 0 else (0, 0)
        work += done
        if left == 0 and part == 1.0:
            return work
        failures += left > 0
        if failures > FAILURES:
            return STUCK
        # The way is long, or long edges are in it.
        work += exchange(surface, network, px, py, pz, IN_CHART, 1.0, 0.0, rule)
        _set_out(network)
        part = min(1.0, 2.0 * part) if left == 0 else max(SHORTEST, 0.5 * part)
    return STUCK


@inner
def _put_row(network: Network) -> int:
    """Put the vertices of a row in their new places: none was moved alone."""
    for i in range(network.out.size - GHOSTS):
        if network.out[i] >= 0:
            put(network, i, _goal(network, i, 1.0))
    return 0


@inner
def _aim(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats) -> bool:
    """Set where all vertices go, the chart of the points; return whether all are numbers."""
    work = network.work
    for i in range(-GHOSTS, network.out.size - GHOSTS):
        if network.out[i] >= 0:
            end = place_of(network, i)
            if i >= 0:
                end = chart_of(surface, px[i], py[i], pz[i])
                if not abs(px[i]) + abs(py[i]) + abs(pz[i]) + abs(end[0]) < math.inf:
                    return False
            elif end[2] != 0.0:
                end = middle_of_patch(surface, network, px, py, pz)
            work.to_u[i], work.to_v[i], work.to_w[i] = end
    return True


@inner
def _come_near(surface: Surface, network: Network) -> None:
    """Set where all vertices come from: where they are, shifted by periods to be near to where they go."""
    for i in range(-GHOSTS, network.out.size - GHOSTS):
        if network.out[i] >= 0:
            put(network, i, _nearest(surface, place_of(network, i), _goal(network, i, 1.0)))
    _set_out(network)


@inner
def _nearest(surface: Surface, place: Place, other: Place) -> Place:
    """Return the image of a place that is nearest to another one."""
    if surface.bends == SPHERE:
        return place
    return (
        other[0] - nearest_image(other[0] - place[0], period_u(surface)),
        other[1] - nearest_image(other[1] - place[1], period_v(surface)),
        place[2],
    )


@inner
def _set_out(network: Network) -> None:
    """Vertices come from where they are."""
    work = network.work
    for i in range(network.out.size):
        work.from_u[i], work.from_v[i], work.from_w[i] = place_of(network, i)


@inner
def _put_back(network: Network) -> None:
    """Put all vertices back to where they come from."""
    for i in range(network.out.size):
        put(network, i, _origin(network, i))


@inner
def _origin(network: Network, i: int) -> Place:
    """Return where vertex i comes from."""
    return network.work.from_u[i], network.work.from_v[i], network.work.from_w[i]


@inner
def _goal(network: Network, i: int, part: float) -> Place:
    """Return where vertex i is after a part of its way; at the end of it to the last bit."""
    end = network.work.to_u[i], network.work.to_v[i], network.work.to_w[i]
    return end if part == 1.0 else on_the_way(_origin(network, i), end, part)


@inner
def _put_all(surface: Surface, network: Network, part: float) -> int:
    """Put all vertices a part of the way on, but those near a triangle that would not turn left; these are queued."""
    for i in range(-GHOSTS, network.out.size - GHOSTS):
        network.work.waiting[i] = 0
        if network.out[i] >= 0:
            put(network, i, _goal(network, i, part))
    count = 0
    for t in range(network.triangles[0]):
        count = _keep_back(surface, network, 3 * t, count)
    done = 0
    while done < count:
        count = _keep_back_around(surface, network, network.work.queue[done], count)
        done += 1
    return count


@inner
def _keep_back_around(surface: Surface, network: Network, i: int, count: int) -> int:
    """Keep back the vertices of the triangles of i that do not turn left; how many are kept back by now."""
    h = network.out[i]
    while True:
        count = _keep_back(surface, network, h, count)
        h = around(network, h)
        if h == network.out[i]:
            return count


@inner
def _keep_back(surface: Surface, network: Network, h: int, count: int) -> int:
    """Put the vertices of the triangle of h back and into the queue if it does not turn left; how many are in it."""
    work, corner = network.work, network.corner
    i, j, k = corner[h], corner[following(h)], corner[preceding(h)]
    if turn(surface, network, i, j, k) > 0.0:
        return count
    for vertex in (i, j, k):
        if not work.waiting[vertex]:
            work.waiting[vertex] = 1
            work.queue[count] = vertex
            count += 1
            put(network, vertex, _origin(network, vertex))
    return count


@inner
def _move_alone(
    surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, rule: int, part: float
) -> tuple[int, int]:
    """Move the vertices of the queue one by one, by their numbers; how many did not arrive, and the work."""
    count, work = _in_order(network), 0
    for attempt in range(ROUNDS):
        left = 0
        for place in range(count):
            i = network.work.queue[place]
            flips, arrived = _try(surface, network, px, py, pz, rule, i, attempt, _goal(network, i, part))
            work += 1 + flips
            if not arrived:
                network.work.queue[left] = i
                left += 1
        count = left
        if count == 0:
            break
    return count, work


@inner
def _try(
    surface: Surface,
    network: Network,
    px: Floats,
    py: Floats,
    pz: Floats,
    rule: int,
    i: int,
    attempt: int,
    end: Place,
) -> tuple[int, bool]:
    """Move vertex i to its end, or else half of the way, or not at all; the flips, and whether it has arrived."""
    goal = end
    for trial in range(2):
        flips = carry(surface, network, px, py, pz, rule, i, goal)
        if flips >= 0:
            return flips, trial == 0
        goal = _aside(surface, place_of(network, i), end, attempt)
    return 0, False


@inner
def _aside(surface: Surface, begin: Place, end: Place, attempt: int) -> Place:
    """Compute half of a way that is not free: straight on, or to the left or right of it, by turns."""
    a, b, c = begin
    du, dv, dw = 0.5 * (end[0] - a), 0.5 * (end[1] - b), 0.5 * (end[2] - c)
    left = (-dv, du, 0.0)
    if surface.bends == SPHERE:
        left = (b * dw - c * dv, c * du - a * dw, a * dv - b * du)
    aside = 0.5 * (attempt % 3 - 1)
    return a + du + aside * left[0], b + dv + aside * left[1], c + dw + aside * left[2]


@inner
def _in_order(network: Network) -> int:
    """Sort the queue by number, ghosts first; return how many are in it."""
    count = 0
    for i in range(-GHOSTS, network.out.size - GHOSTS):
        if network.work.waiting[i]:
            network.work.queue[count] = i
            count += 1
    return count
