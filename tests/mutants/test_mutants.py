"""Mutants are those that are meant, nothing else is changed, and their tests are the nearest ones."""

import ast

import pytest

from tests.mutants import reach
from tests.mutants.__main__ import MUTATED
from tests.mutants.operators import mutants


def changes(text):
    return [(mutant.before, mutant.after) for mutant in mutants(text)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b", [("a + b", "(a - b)")]),
        ("c = x ** 2", [("x ** 2", "(x * 2)"), ("2", "3")]),
        ("a < b", [("a < b", "(a <= b)"), ("a < b", "(a > b)")]),
        ("a == b", [("a == b", "(a != b)")]),
        ("not a or -b", [("not a or -b", "(not a and -b)"), ("not a", "(a)"), ("-b", "(b)")]),
        ("y = 0.5", [("0.5", "1.0")]),
        ("y = 0.0", [("0.0", "1.0")]),
        ("y = np.inf", [("np.inf", "(-np.inf)")]),
        ("y = min(a, b)", [("min(a, b)", "(max(a, b))")]),
        ("y = z.any()", [("z.any()", "(z.all())")]),
        ("fill(a)", [("fill(a)", "pass")]),
        ("a += b", [("a += b", "a -= b"), ("a += b", "pass")]),
        ("a[k] = b", [("a[k] = b", "pass")]),
        ("flag = True", []),
        ("def f(a: Literal[3] = None) -> Literal[4]:\n    '''5'''", []),
        ("raise Failure(a + 1)", []),
        ("y = f'{a + 1}'", []),
        ("names = [*first, 'b'] + ['a']", []),
        ("if TYPE_CHECKING:\n    a = 1", []),
        ("@wraps(a + 1)\ndef f():\n    pass", []),
    ],
)
def test_what_is_replaced(text, expected):
    assert changes(text) == expected


def test_one_place_is_changed_and_the_rest_stays():
    text = 'class A:\n    """ä"""  # two bytes before\n\n    def f(self, x):\n        return (x -  1) * x  # why\n'
    found = list(mutants(text))
    assert [mutant.text.splitlines()[4].strip() for mutant in found] == [
        "return ((x - 1) / x)  # why",
        "return ((x + 1)) * x  # why",
        "return (x -  2) * x  # why",
    ]
    assert {(mutant.scope, mutant.line) for mutant in found} == {("f", 5)}
    for mutant in found:
        ast.parse(mutant.text)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "nearest"),
    [
        ("dincl/projection/closed_form.py", "tests/dincl/projection/test_projection_closed_form.py"),
        ("meanfield/transport/wasserstein.py", "tests/meanfield/test_w1.py"),
        ("tissue/events/basal.py", "tests/tissue/test_events.py"),  # imported by a name that is computed
    ],
)
def test_the_tests_of_a_module_are_the_nearest(module, nearest):
    names = [str(path.relative_to(reach.ROOT)) for path in reach.tests_of(reach.ROOT / module)]
    assert nearest in names[:4]
    assert "tests/contracts/test_house.py" not in names


def test_what_is_mutated_exists():
    assert [path for path in MUTATED if not (reach.ROOT / path).exists()] == []
