"""Small tissues for tests: made by hand from points, or random and feasible; lengths in R_soft, times in hours."""

import numpy as np

from tissue.files.parameters import preset
from tissue.state.cells import CellLayers, Cells, empty

# The thesis, with cells without INM as in the published program.
THESIS = preset("thesis").numbers()._replace(resting_cells_enlarge=True)
HEIGHT = 8.0
SPACING = 1 / 6  # of basal and apical points of random tissues: half of the maximal basal distance
PATIENCE = 500  # throws of a nucleus near its place
ENLARGED = 0.1  # part of the cells of random tissues that have the enlarged radius


def numbers(**changes):
    """The numbers of the thesis with some of them changed."""
    return THESIS._replace(**changes)


def layers(n, apical=None, basal=None):
    """All n cells in both layers, or just those named."""
    everyone = np.arange(n, dtype=np.int64)
    return CellLayers(*(everyone if named is None else np.array(named, dtype=np.int64) for named in (apical, basal)))


def tissue(x, a, b, **fields):
    """Cells with nuclei x, apical points a, basal points b, each (n, 2); further fields one for all or (n,).

    Not given are: rest lengths 1.5 (junctions 1/3), stiffnesses and hard radius of the thesis, age 0, cycle 15 h.
    """
    points = np.hstack([np.asarray(part, dtype=np.float64).reshape(-1, 2) for part in (x, a, b)])
    n = len(points)
    given = {
        "rest_ax": 1.5,
        "rest_bx": 1.5,
        "rest_aa": THESIS.new_junction,
        "stiff_ax": THESIS.alpha_ax,
        "stiff_bx": THESIS.alpha_bx,
        "stiff_axb": THESIS.alpha_axb,
        "stiff_aa": THESIS.alpha_aa,
        "radius": THESIS.hard_radius,
        "cycle": 15.0,
        "moves": True,
        "divides": True,
        "id": np.arange(n),
        "mother": -1,
        **dict(zip(("x", "y", "ax", "ay", "bx", "by"), points.T, strict=True)),
        **fields,
    }
    made = empty(n)
    for name, value in given.items():
        getattr(made, name)[:] = value
    return made


def cells(n, seed, **fields):
    """A random feasible tissue of n cells in a box of height 8 and width n/6, each nucleus above its basal point.

    Basal and apical points are 1/6 apart, hard discs are apart, every tenth nucleus or so is enlarged. Rest lengths
    and stiffnesses are drawn for each cell. As crowded as a real one: a soft disc overlaps nine others on average.
    """
    rng = np.random.default_rng(seed)
    place = SPACING * (np.arange(n) - (n - 1) / 2)
    radius = np.where(rng.uniform(size=n) < ENLARGED, THESIS.enlarged_radius, THESIS.hard_radius)
    a = np.column_stack((place, HEIGHT + rng.uniform(-0.3, 0.3, n)))
    b = np.column_stack((place, np.zeros(n)))
    drawn = {
        "radius": radius,
        "rest_ax": rng.uniform(0.5, 4.0, n),
        "rest_bx": rng.uniform(0.5, 4.0, n),
        "rest_aa": rng.uniform(0.05, 0.5, n),
        "stiff_ax": THESIS.alpha_ax * rng.uniform(0.5, 2.0, n),
        "stiff_bx": THESIS.alpha_bx * rng.uniform(0.5, 2.0, n),
        "stiff_axb": THESIS.alpha_axb * rng.uniform(0.5, 2.0, n),
        "cycle": rng.uniform(THESIS.min_cycle, THESIS.max_cycle, n),
        "stiff_aa": THESIS.alpha_aa * np.random.default_rng((seed, n)).uniform(0.5, 2.0, n),
    }
    return tissue(_thrown(rng, place, radius), a, b, **{**drawn, **fields})


def start(n, seed):
    """The same positions as a run begins with: all cells alike, rest lengths 1.5, junctions at rest."""
    same = {"rest_ax": 1.5, "rest_bx": 1.5, "rest_aa": SPACING, "stiff_ax": THESIS.alpha_ax}
    same |= {"stiff_bx": THESIS.alpha_bx, "stiff_axb": THESIS.alpha_axb, "stiff_aa": THESIS.alpha_aa}
    same |= {"radius": THESIS.hard_radius}
    return cells(n, seed, **same)


def _thrown(rng, place, radius):
    """Nuclei thrown around their places one after another, again where a hard disc is hit, in the end from farther."""
    centres = np.zeros((len(place), 2))
    for i in range(len(place)):
        free, throws = False, 0
        while not free:
            aside = max(1.0, throws / PATIENCE)
            centres[i] = place[i] + rng.uniform(-aside, aside), rng.uniform(0.15, 0.85) * HEIGHT
            free = (np.hypot(*(centres[:i] - centres[i]).T) >= radius[:i] + radius[i]).all()
            throws += 1
    return centres


def divided(mother, cell, offset=THESIS.offset):
    """The tissue right after a division: ``cell`` is two, both ``offset`` from where it was, overlapping  (3.7).

    The second daughter follows the first in the arrays; ``layers(n + 1)`` are its layers.
    """
    twice = Cells(*(np.insert(array, cell + 1, array[..., cell], axis=-1) for array in mother))
    for name in ("x", "ax", "bx"):
        getattr(twice, name)[cell : cell + 2] += (-offset, offset)
    twice.radius[cell : cell + 2] = THESIS.hard_radius
    twice.rest_aa[cell] = THESIS.new_junction
    twice.id[:] = np.arange(len(twice.id))
    return twice
