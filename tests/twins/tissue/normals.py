"""The normal numbers of the noise in substeps again in plain NumPy: Threefry-2x32, Box and Muller."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tissue.state.cells import Floats, Integers

WORDS = 2.0**32


def normals(key: Sequence[int], counter: Integers, number: int) -> Floats:
    """Twin of ``normals.normals``: pairs (2, n) of independent N(0, 1) for counters (counter_i, number)."""
    u, v = ((words + 0.5) / WORDS for words in threefry(key, counter, number))
    return np.sqrt(-2 * np.log(u)) * np.array([np.cos(2 * np.pi * v - np.pi), np.sin(2 * np.pi * v - np.pi)])


def threefry(key: Sequence[int], counter: Integers, number: int) -> tuple[Floats, Floats]:
    """Twin of ``normals.threefry`` for one key: words (n,), (n,) as doubles."""
    keys = [np.uint32(word) for word in (*key, key[0] ^ key[1] ^ 0x1BD11BDA)]
    x, y = counter.astype(np.uint32), np.full(len(counter), number, np.uint32)
    for made in range(6):  # five times four rounds, the key before and after each four
        x = x + keys[made % 3]
        y = y + keys[(made + 1) % 3] + np.uint32(made)
        for turn in ((13, 15, 26, 6), (17, 29, 16, 24))[made % 2] if made < 5 else ():
            x = x + y
            y = (y << np.uint32(turn) | y >> np.uint32(32 - turn)) ^ x
    return x.astype(np.float64), y.astype(np.float64)
