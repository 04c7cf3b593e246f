"""Whether tissues and runs agree in every bit."""


def arrays(frame):
    """All arrays that a saved state has."""
    past, sheets = frame.checkpoint, frame.sheets
    of_space = () if sheets is None else (*sheets.apical, *sheets.basal)
    return (*frame.cells, *frame.layers, *past.emt, past.counts, past.generators, *of_space)


def same(a, b):
    """Whether two saved states agree in every bit of all that a run is."""
    rest = [(one.t, one.checkpoint.seed, one.checkpoint.next_id) for one in (a, b)]
    return rest[0] == rest[1] and all(p.tobytes() == q.tobytes() for p, q in zip(arrays(a), arrays(b), strict=True))


def same_end(a, b):
    """Whether the run b is the end of the run a."""
    tail = a.frames[-len(b.frames) :]
    return a.stats == b.stats and all(map(same, tail, b.frames))


def same_cells(a, b):
    """Whether two tissues agree in every bit of their cells and layers, and frames in their times."""
    arrays = zip((*a.cells, *a.layers), (*b.cells, *b.layers), strict=True)
    return getattr(a, "t", 0) == getattr(b, "t", 0) and all(p.tobytes() == q.tobytes() for p, q in arrays)
