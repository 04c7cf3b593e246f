"""A network again in plain Python: triangles as triples, in no order."""

from itertools import pairwise

import numpy as np

from tissue.state.surface import SPHERE


def triangles_of(network):
    """The set of triangles, each from its smallest vertex on."""
    return {turned(triangle) for triangle in network.corner[: 3 * network.triangles[0]].reshape(-1, 3).tolist()}


def turned(triangle):
    """The same triangle from its smallest vertex on."""
    k = triangle.index(min(triangle))
    return (*triangle[k:], *triangle[:k])


def lengths_of(network):
    """The rest length of each half-edge by its ends."""
    h = range(3 * network.triangles[0])
    return {(int(network.corner[k]), int(network.corner[network.twin[k]])): float(network.rest[k]) for k in h}


def neighbours_around(triangles, i):
    """The neighbours of vertex i counterclockwise, from the smallest on."""
    after = {}
    for triangle in triangles:
        if i in triangle:
            k = triangle.index(i)
            after[triangle[(k + 1) % 3]] = triangle[(k + 2) % 3]
    ring = [min(after)]
    while after[ring[-1]] != ring[0]:
        ring.append(after[ring[-1]])
    return ring


def turn(surface, chart, i, j, k):
    """Twin of ``chart.turn`` for cells, with a chart (n, 2 or 3) of points that are far from the ends of periods."""
    a, b, c = chart[[i, j, k]]
    if surface.bends == SPHERE:
        return np.linalg.det(np.array((a, b, c)))
    return float(np.linalg.det(np.array((b - a, c - a))))


def remove(surface, chart, points, triangles, i):
    """Twin of ``remove`` for a cell that is not at a boundary: the triangles then, or None if it cannot leave."""
    ring = neighbours_around(triangles, i)
    rest = {t for t in triangles if i not in t}
    edges = {(t[a], t[(a + 1) % 3]) for t in rest for a in range(3)}
    made = set()
    while len(ring) > 3:
        ears = [tip for tip in range(len(ring)) if is_ear(surface, chart, ring, tip, edges)]
        if not ears:
            return None
        tip = min(ears, key=lambda k: np.linalg.norm(points[ring[k - 1]] - points[ring[(k + 1) % len(ring)]]))
        ear = (ring[tip - 1], ring[tip], ring[(tip + 1) % len(ring)])
        made.add(turned(list(ear)))
        edges |= {(ear[0], ear[2]), (ear[2], ear[0])}
        ring = ring[:tip] + ring[tip + 1 :]
    return rest | made | {turned(ring)}


def is_ear(surface, chart, ring, tip, edges):
    """Whether a corner of a polygon turns left, has no other one in it, and may be cut off."""
    before, at, after = ring[tip - 1], ring[tip], ring[(tip + 1) % len(ring)]
    if (before, after) in edges or turn(surface, chart, before, at, after) <= 0:
        return False
    sides = ((before, at), (at, after), (after, before))
    others = [other for other in ring if other not in (before, at, after)]
    return not any(all(turn(surface, chart, *side, other) >= 0 for side in sides) for other in others)


def insert(chart, triangles, mother, daughter, direction):
    """Twin of ``insert`` for cells that are not at a boundary, with a direction on the chart: the triangles then."""
    ring = neighbours_around(triangles, mother)
    ways = chart[ring] - chart[mother]
    areas = direction[0] * ways[:, 1] - direction[1] * ways[:, 0]
    if chart.shape[1] == 3:
        areas = np.cross(direction, ways) @ chart[mother]
    sines = areas / np.linalg.norm(ways, axis=1)
    right, left = int(sines.argmin()), int(sines.argmax())
    ring = ring[right:] + ring[:right]
    left = (left - right) % len(ring)
    ahead, behind = ring[: left + 1], [*ring[left:], ring[0]]
    result = {t for t in triangles if mother not in t}
    for vertex, line in ((daughter, ahead), (mother, behind)):
        result |= {turned([vertex, a, b]) for a, b in pairwise(line)}
    return result | {turned([mother, daughter, ring[left]]), turned([daughter, mother, ring[0]])}
