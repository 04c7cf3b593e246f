"""All studies whose tables come with the program, by the names of these, in the order in which they can be made."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from dincl.study import Study
from verification.methods import studies as methods
from verification.thesis import studies as thesis
from verification.tissues import studies as tissues

STUDIES: Mapping[str, Callable[..., Study]] = {**methods.STUDIES, **thesis.STUDIES, **tissues.STUDIES}
