"""Compiled code: the one room that knows numba's insides.

1. ``kernel`` and ``c_function`` compile a function and keep its machine code on the disk.
2. ``inner`` and ``maker`` compile the parts of kernels: those that allocate no arrays, and those that do.
3. ``call`` makes the function with which kernels call a C function of a ``signature`` by its address.
4. ``StructPointer`` places a named tuple of arrays and numbers in memory; kernels get it by its address.
5. ``dincl.compiled.lanes`` has the operations on one number or on several in one register.
6. ``heard`` collects what compiled functions of a user raise.

Parts and structs cost nothing at run time. Every use of a name that numba or llvmlite may change is in this package,
and ``tests/dincl/compiled`` has a test for each.
"""

from dincl.compiled.calls import DOUBLES, call, signature
from dincl.compiled.functions import c_function, kernel
from dincl.compiled.parts import inner, maker
from dincl.compiled.raised import heard
from dincl.compiled.structs import StructPointer, reader, struct_type

__all__ = [
    "DOUBLES",
    "StructPointer",
    "c_function",
    "call",
    "heard",
    "inner",
    "kernel",
    "maker",
    "reader",
    "signature",
    "struct_type",
]
