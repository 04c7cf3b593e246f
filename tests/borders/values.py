"""Values that users pass by mistake, and functions that fail, for any argument of any function."""

import decimal
import fractions
import math
import warnings
from itertools import count

import numpy as np


class Raising:
    """Raises whatever it is asked."""

    def _fails(self, *_, **__):
        raise OSError("do not ask")

    __repr__ = __str__ = __float__ = __int__ = __index__ = __len__ = __iter__ = __getitem__ = __array__ = _fails
    __bool__ = __lt__ = __le__ = __gt__ = __ge__ = __neg__ = __abs__ = __contains__ = _fails


class Lying:
    """Says that it has entries, and has none."""

    def __len__(self):
        return 3

    def __getitem__(self, k):
        raise KeyError(k)


def endless():
    """A list that holds itself."""
    held = [1.0]
    held.append(held)
    return held


def matrix():
    """A numpy.matrix, without the warning of its maker."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return np.matrix([[0.0, 1.0], [2.0, 3.0]])


def raises(error):
    """A function of anything that raises."""

    def failing(*_, **__):
        raise error

    return failing


def returns(value):
    """A function of anything that returns a value."""
    return lambda *_, **__: value


NUMBERS = (
    *(0, 1, -1, 2, 10**18, 2**63, 2**64, 10**400, -(10**400), 10**5000, 0.0, -0.0, 0.5, -3.25, True, np.True_),
    *(1e300, -1e300, 1e101, 1e100, 1e-300, 5e-324, math.nan, math.inf, -math.inf, 1j, np.complex128(1 + 1j)),
    *(np.float32(0.5), np.uint64(2**64 - 1), np.timedelta64(3, "s"), np.datetime64("2020-01-01")),
    *(fractions.Fraction(10**400, 3), decimal.Decimal("NaN"), decimal.Decimal("sNaN"), np.longdouble("1e1000")),
)
THINGS = (
    *(None, "", "0.5", "all", b"1", bytearray(b"1"), memoryview(b"1"), {1.0}, {"a": 1}, object, object(), print, ...),
    *(Raising(), Lying(), [Raising()], endless(), (k for k in range(3)), count(), range(3), NotImplemented),
)
ARRAYS = (
    *([], [[]], [[[]]], [1.0], [1.0, 2.0], [0, 1], [[0, 1]], [[0.0, 1.0], [2.0, 3.0]], [[1.0], [1.0, 2.0]], [None]),
    *([[10**400, 0.0]], [math.nan, 0.0], [[math.inf, 1.0]], [[1e300, 0.0]], [[1e-300, 0.0]], [1j, 0.0], ["a", "b"]),
    *(np.zeros((0, 2)), np.zeros((2, 2)), np.ones((3, 2)), np.ones((2, 3)), np.ones((1, 1, 1)), np.array(1.0)),
    *(np.array([1, 2], dtype=object), np.array([None, 1.0]), np.ones((2, 2), dtype=bool), np.array(["a"])),
    *(np.ma.masked, np.ma.masked_less([[0.0, 1.0], [2.0, 3.0]], 0.5), [1.0, np.ma.masked], matrix(), [[[1.0]] * 2] * 2),
    *(np.ones((2, 2), dtype=np.float16), np.ones((2, 2), dtype=">f8"), np.array([[2**63]], dtype=np.uint64)),
    *(
        np.array([np.longdouble("1e1000")]),
        np.rec.array([(1.0, 2.0)]),
        [np.ones(2), [1.0]],
        [(0, 2**63)],
        [[-1, 10**30]],
    ),
)
FUNCTIONS = (
    *map(
        raises, (KeyError("k"), ValueError(), RuntimeError("no"), OSError(2, "no"), AssertionError(), StopIteration())
    ),
    *map(raises, (RecursionError(), ZeroDivisionError(), Warning("w"), np.linalg.LinAlgError("singular"), EOFError())),
    *(
        raises(UnicodeDecodeError("utf-8", b"", 0, 1, "no")),
        lambda: 0.0,
        lambda *a: a[0].no,
        lambda *a: np.log(-1.0 * a[-1]),
    ),
    *map(returns, (*THINGS, *ARRAYS, *NUMBERS)),
    *(lambda *a: a[-1] * 1e300, lambda *a: np.sqrt(-abs(a[-1])), lambda *a: a[-1] / 0.0, lambda *a: a),
)
ABSURD = (*NUMBERS, *THINGS, *ARRAYS, *FUNCTIONS)
