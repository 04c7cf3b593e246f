"""Provenance of numbers: the code that a function reaches, the data beside it, the libraries, the settings.

No list is kept by hand: the code is found by following import statements.
"""

from dincl.provenance.code import Closure, closure
from dincl.provenance.record import differences, libraries, provenance

MAKES_NO_NUMBERS = True
__all__ = ["Closure", "closure", "differences", "libraries", "provenance"]
