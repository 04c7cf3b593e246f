"""Compiled code: with the lanes of tissue the one room that uses parts of numba that are not its public interface.

1. ``kernel`` and ``c_function`` compile a function and cache its machine code on the disk.
2. ``inner`` and ``allocating`` compile functions that are inlined into kernels: without new arrays, and with them.
3. ``call`` makes the function with which kernels call a C function of a ``signature`` by its address.
4. ``StructPointer`` places a named tuple of arrays and numbers in memory; kernels get it by its address.
5. ``collect_errors`` collects what compiled functions of a user raise.

Inlined functions and structs cost nothing at run time. Every use of a name that numba or llvmlite may change is in
this package or in ``tissue.kernels`` (lanes, vectors, generators), and their tests have one for each.
"""

from dincl.compiled.calls import DOUBLES, call, signature
from dincl.compiled.functions import allocating, c_function, inner, kernel
from dincl.compiled.structs import StructPointer, reader, struct_type
from dincl.compiled.uncaught import collect_errors

__all__ = [
    "DOUBLES",
    "StructPointer",
    "allocating",
    "c_function",
    "call",
    "collect_errors",
    "inner",
    "kernel",
    "reader",
    "signature",
    "struct_type",
]
