"""Pieces of the apical layer in a tree of boxes: its point nearest to a nucleus, and where the layer crosses itself.

The pieces are the junctions of a slice and the triangles of a sheet. Half of the pieces of a box are in each of the two
boxes below it, so that a question looks at a number of boxes that grows as the logarithm of the number of pieces. The
answers are exact: a box is left out only if nothing in it can change the answer.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.model.scale import Point, crossing_of_ray, junctions_cross, minus, nearest_on_junction, nearest_on_triangle
from tissue.network.neighbours import apical_points, fresh_triangles
from tissue.state.cells import Floats, Integers
from tissue.state.running import APICAL, IN_SPACE, Kind, TissueState
from tissue.state.space import FLAT

# Squares of distances to a box and to a piece in it differ by rounding: boxes that are this much farther are left out.
TIE = 1e-9


class ApicalTree(NamedTuple):
    """The pieces, in an order in which neighbours are near each other, and boxes around them; lengths in R_soft."""

    corners: Integers  # (p, 2) or (p, 3): the cells whose apical points are the corners
    points: Floats  # (p, 2 or 3, 3): of one image, whose middle is in the first period
    numbers: Integers  # (p,): which of two pieces counts that are equally near: the one with the lower number
    boxes: Floats  # (2 leaves, 6): lowest and highest coordinates; below box k are 2 k and 2 k + 1, the root is 1
    period_x: float  # inf for none
    period_z: float
    looks: Integers  # (1,): how many boxes were looked at


def apical_tree(state: TissueState) -> ApicalTree:
    """Return the tree of the apical layer of a tissue; the layer must have a cell."""
    if state.space.dimension == FLAT:
        return _of_junctions(state)
    surface, corners = state.space.surface, fresh_triangles(state, *apical_points(state), state.space.apical)
    points: Floats = np.stack([array[corners] for array in (state.cells.ax, state.cells.ay, state.cells.az)], axis=-1)
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            apart = points[:, :, axis] - points[:, :1, axis]
            points[:, :, axis] -= period * np.round(apart / period)
            points[:, :, axis] -= period * np.floor(points[:, :, axis].mean(axis=1, keepdims=True) / period)
    order = _halved(points.mean(axis=1))
    tree = _with_room(corners[order], points[order], order, surface.period_x, surface.period_z)
    _put_boxes(tree.points, tree.boxes)
    return tree


def _of_junctions(state: TissueState) -> ApicalTree:
    """Return the tree of a slice, in the order of its layer; a layer of one cell is a point."""
    size = int(state.sizes[APICAL])
    p = size if state.curve.ring > 0.0 else max(1, size - 1)
    tree = _with_room(np.empty((p, 2), np.int64), np.zeros((p, 2, 3)), np.arange(p), math.inf, math.inf)
    _put_junctions(state, tree.corners, tree.points)
    _put_boxes(tree.points, tree.boxes)
    return tree


def _with_room(corners: Integers, points: Floats, numbers: Integers, period_x: float, period_z: float) -> ApicalTree:
    """Return a tree whose boxes are not made yet."""
    leaves = 1 << max(0, len(corners) - 1).bit_length()
    return ApicalTree(corners, points, numbers, np.empty((2 * leaves, 6)), period_x, period_z, np.zeros(1, np.int64))


@kernel
def _put_junctions(state: TissueState, corners: Integers, points: Floats) -> None:
    """Write both cells of each junction, and their apical points."""
    cells, layer, size = state.cells, state.layers.apical, state.sizes[APICAL]
    for k in range(len(corners)):
        for c in range(2):
            i = layer[k + c if k + c < size else 0]
            corners[k, c], points[k, c, 0], points[k, c, 1] = i, cells.ax[i], cells.ay[i]


def _halved(points: Floats) -> Integers:
    """Return an order of points (p, 3) in which those of each box of the tree are near each other.

    The points of a box are sorted along its longest side, and each half of them is a box.
    """
    order = np.arange(len(points))
    size = 1 << max(0, len(points) - 1).bit_length()
    while size > 1:
        now, begins, box = points[order], np.arange(0, len(points), size), np.arange(len(points)) // size
        sides = np.maximum.reduceat(now, begins) - np.minimum.reduceat(now, begins)
        along = np.take_along_axis(now, sides.argmax(axis=1)[box, None], axis=1)[:, 0]
        order = order[np.lexsort((along, box))]
        size //= 2
    return order


@kernel
def _put_boxes(points: Floats, boxes: Floats) -> None:
    """Make the boxes: of each piece, then of each two boxes, up to the root. An empty box is nowhere."""
    leaves = len(boxes) // 2
    for k in range(leaves):
        for axis in range(3):
            low, high = math.inf, -math.inf
            if k < len(points):
                for c in range(points.shape[1]):
                    low, high = min(low, points[k, c, axis]), max(high, points[k, c, axis])
            boxes[leaves + k, axis], boxes[leaves + k, 3 + axis] = low, high
    for k in range(leaves - 1, 0, -1):
        for axis in range(3):
            boxes[k, axis] = min(boxes[2 * k, axis], boxes[2 * k + 1, axis])
            boxes[k, 3 + axis] = max(boxes[2 * k, 3 + axis], boxes[2 * k + 1, 3 + axis])


@inner
def _behind(box: int) -> int:
    """Return the next box that is not below this one, from left to right; 0 after the last."""
    while box & 1:
        box >>= 1
    return box + 1 if box else 0


@inner
def nearest_point(tree: ApicalTree, x: float, y: float, z: float, kind: Kind) -> Point:
    """Return the point of the layer that is nearest to a point, of several the one on the piece with the lowest number.

    Where there are periods it is an image: its height is right, and its distance from an image of the point.
    """
    many_x, many_z = 1 if tree.period_x == math.inf else 3, 1 if tree.period_z == math.inf else 3
    best, number, found = math.inf, -1, (math.nan, math.nan, math.nan)
    for image in range(many_x * many_z):
        at = _image(x, tree.period_x, image % many_x), y, _image(z, tree.period_z, image // many_x)
        best, number, found = _nearer(tree, at, best, number, found, kind)
    return found


@inner
def _image(at: float, period: float, image: int) -> float:
    """Return a coordinate in the first period; of its images 1 and 2 that behind and before it."""
    if period == math.inf:
        return at
    inside = at - period * math.floor(at / period)
    return inside + (period if image == 1 else -period if image == 2 else 0.0)


@inner
def _nearer(
    tree: ApicalTree, at: Point, best: float, number: int, found: Point, kind: Kind
) -> tuple[float, int, Point]:
    """Return the squared distance to the nearest point, the number of its piece, and the point.

    ``best``, ``number`` and ``found`` are those of another image, with the number -1 if there is none.
    """
    leaves, box = len(tree.boxes) // 2, 1
    if number < 0:  # some near piece, to begin with
        while box < leaves:
            box *= 2
            if _square_to(tree, box + 1, at) < _square_to(tree, box, at):
                box += 1
            tree.looks[0] += 2
        best, found = _of_piece(tree, box - leaves, at, kind)
        number, box = tree.numbers[box - leaves], 1
    while box > 0:
        tree.looks[0] += 1
        if _square_to(tree, box, at) > best * (1.0 + TIE):
            box = _behind(box)
        elif box < leaves:
            box *= 2
        else:
            if box - leaves < len(tree.numbers):
                square, point = _of_piece(tree, box - leaves, at, kind)
                mine = tree.numbers[box - leaves]
                if square < best or (square == best and mine < number):
                    best, number, found = square, mine, point
            box = _behind(box)
    return best, number, found


@inner
def _square_to(tree: ApicalTree, box: int, at: Point) -> float:
    """Return the squared distance from a point to a box."""
    boxes = tree.boxes
    dx = max(boxes[box, 0] - at[0], at[0] - boxes[box, 3], 0.0)
    dy = max(boxes[box, 1] - at[1], at[1] - boxes[box, 4], 0.0)
    dz = max(boxes[box, 2] - at[2], at[2] - boxes[box, 5], 0.0)
    square: float = dx * dx + dy * dy + dz * dz
    return square


@inner
def corner(tree: ApicalTree, k: int, c: int) -> Point:
    """Return corner c of piece k."""
    return tree.points[k, c, 0], tree.points[k, c, 1], tree.points[k, c, 2]


@inner
def _of_piece(tree: ApicalTree, k: int, at: Point, kind: Kind) -> tuple[float, Point]:
    """Return the squared distance from a point to a piece, and the nearest point of the piece."""
    if len(kind) != IN_SPACE:
        return nearest_on_junction(at, corner(tree, k, 0), corner(tree, k, 1))
    return nearest_on_triangle(at, corner(tree, k, 0), corner(tree, k, 1), corner(tree, k, 2))


@inner
def winding(tree: ApicalTree, x: float, y: float) -> int:
    """Return how often the closed apical layer of a slice goes around a point, counterclockwise."""
    leaves, box, around = len(tree.boxes) // 2, 1, 0
    while box > 0:
        tree.looks[0] += 1
        if not (tree.boxes[box, 1] <= y <= tree.boxes[box, 4] and tree.boxes[box, 3] >= x):
            box = _behind(box)
        elif box < leaves:
            box *= 2
        else:
            p = tree.points[box - leaves]
            around += crossing_of_ray(x, y, p[0, 0], p[0, 1], p[1, 0], p[1, 1])
            box = _behind(box)
    return around


@inner
def crossings(tree: ApicalTree, reach: Floats, kind: Kind) -> tuple[int, float]:
    """Count the pairs of pieces that cross, and measure the longest loop that a crossing closes.

    Pieces are junctions of a slice, or triangles. ``reach``: (p + 1,), the length of the layer up to each junction; a
    loop is the way along the layer from the end of one junction to the beginning of the other one, in a tube the
    shorter way. Triangles close no loop: it is infinite.
    """
    many_x, many_z = 1 if tree.period_x == math.inf else 3, 1 if tree.period_z == math.inf else 3
    leaves, found, loop = len(tree.boxes) // 2, 0, 0.0
    for k in range(len(tree.numbers)):
        for image in range(many_x * many_z):
            shift_x, shift_z = _shift(tree.period_x, image % many_x), _shift(tree.period_z, image // many_x)
            box = 1
            while box > 0:
                tree.looks[0] += 1
                if not _overlap(tree, leaves + k, box, shift_x, shift_z):
                    box = _behind(box)
                elif box < leaves:
                    box *= 2
                else:
                    m = box - leaves
                    if m > k and _cross(tree, k, m, shift_x, shift_z, kind):
                        found += 1
                        loop = max(loop, _loop(tree, reach, k, m))
                    box = _behind(box)
    return found, loop


@inner
def _loop(tree: ApicalTree, reach: Floats, k: int, m: int) -> float:
    """Return the length of the loop between two junctions k < m; infinite between triangles."""
    if tree.points.shape[1] == 3:
        return math.inf
    between = reach[m] - reach[k + 1]
    if tree.corners[0, 0] == tree.corners[len(tree.corners) - 1, 1]:
        between = min(between, reach[k] + reach[len(reach) - 1] - reach[m + 1])
    return float(between)


@inner
def _shift(period: float, image: int) -> float:
    return period if image == 1 else -period if image == 2 else 0.0


@inner
def _overlap(tree: ApicalTree, one: int, other: int, shift_x: float, shift_z: float) -> bool:
    """Return whether two boxes overlap, the first one shifted."""
    b = tree.boxes
    in_x = b[one, 0] + shift_x <= b[other, 3] and b[other, 0] <= b[one, 3] + shift_x
    in_y = b[one, 1] <= b[other, 4] and b[other, 1] <= b[one, 4]
    overlap: bool = in_x and in_y and b[one, 2] + shift_z <= b[other, 5] and b[other, 2] <= b[one, 5] + shift_z
    return overlap


@inner
def _cross(tree: ApicalTree, k: int, m: int, shift_x: float, shift_z: float, kind: Kind) -> bool:
    """Return whether two pieces cross, the first one shifted."""
    if len(kind) != IN_SPACE:
        if _shared(tree, k, 0, m) or _shared(tree, k, 1, m):
            return False
        return junctions_cross(corner(tree, k, 0), corner(tree, k, 1), corner(tree, m, 0), corner(tree, m, 1))
    for c in range(3):
        first, second = c, (c + 1) % 3
        if not (_shared(tree, k, first, m) or _shared(tree, k, second, m)):
            a, b = (
                _shifted(corner(tree, k, first), shift_x, shift_z),
                _shifted(corner(tree, k, second), shift_x, shift_z),
            )
            if _pierces(a, b, corner(tree, m, 0), corner(tree, m, 1), corner(tree, m, 2)):
                return True
        if not (_shared(tree, m, first, k) or _shared(tree, m, second, k)):
            a = _shifted(corner(tree, m, first), -shift_x, -shift_z)
            b = _shifted(corner(tree, m, second), -shift_x, -shift_z)
            if _pierces(a, b, corner(tree, k, 0), corner(tree, k, 1), corner(tree, k, 2)):
                return True
    return False


@inner
def _shifted(a: Point, shift_x: float, shift_z: float) -> Point:
    return a[0] + shift_x, a[1], a[2] + shift_z


@inner
def _shared(tree: ApicalTree, k: int, c: int, m: int) -> bool:
    """Return whether a corner of piece k is one of piece m."""
    shared = False
    for other in range(tree.corners.shape[1]):
        shared = shared or tree.corners[k, c] == tree.corners[m, other]
    return shared


@inner
def _pierces(p: Point, q: Point, a: Point, b: Point, c: Point) -> bool:
    """Return whether the line from p to q goes through the inside of a triangle.

    Its ends lie on different sides of the triangle, and the line has all sides of the triangle on one hand.
    """
    if _volume(a, b, c, p) * _volume(a, b, c, q) >= 0.0:
        return False
    one, two, three = _volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)
    return (one > 0.0 and two > 0.0 and three > 0.0) or (one < 0.0 and two < 0.0 and three < 0.0)


@inner
def _volume(a: Point, b: Point, c: Point, d: Point) -> float:
    """Return six times the volume of a tetrahedron, with a sign."""
    (u, v, w), (p, q, r), (x, y, z) = minus(b, a), minus(c, a), minus(d, a)
    return (v * r - w * q) * x + (w * p - u * r) * y + (u * q - v * p) * z
