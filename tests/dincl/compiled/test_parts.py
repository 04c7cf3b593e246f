"""Parts of kernels: machine code only within kernels, their own text for Python."""

import numpy as np

from dincl.compiled import inner, kernel, maker


@inner
def power(x: float, n: int) -> float:
    """x^n."""
    result = 1.0
    for _ in range(n):
        result *= x
    return result


@maker
def powers(x: float) -> np.ndarray:
    """1, x, x^2."""
    found = np.empty(3)
    for n in range(3):
        found[n] = power(x, n)
    return found


@kernel
def total(x: float) -> float:
    """1 + x + x^2 + x^3."""
    return power(x, 0) + power(x, 1) + power(x, 2) + power(x, 3)


@kernel
def added(x: float) -> float:
    """1 + x + x^2."""
    found = powers(x)
    return float(found[0] + found[1] + found[2])


def compiled_afresh(code, x):
    """What a kernel gives, when its machine code is made here: kept code of an earlier run would need no parts."""
    code(x)
    code.recompile()
    return code(x)


def test_a_part_is_machine_code_only_within_kernels():
    assert compiled_afresh(added, 3.0) == 13.0
    for part in (power, powers):
        (compiled,) = part.overloads.values()
        assert compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name) == 0
    (compiled,) = added.overloads.values()
    assert compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name) != 0


def test_python_runs_the_text_of_a_part_compiled_or_not():
    assert power(3, 2) == 9.0
    total(1.0)
    assert power(3, 2) == 9.0
    assert powers(2.0).tolist() == [1.0, 2.0, 4.0]
