"""Compiled code: how functions become machine code, how it is kept, and how it is called."""

from dincl.compiled.functions import c_function, heard, inner, kernel, maker

__all__ = ["c_function", "heard", "inner", "kernel", "maker"]
