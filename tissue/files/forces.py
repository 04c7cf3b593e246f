"""The section [forces] of a parameter file: forces that are not of the thesis."""

from __future__ import annotations

from pydantic import ConfigDict, ValidationInfo, model_validator

from tissue.files.fields import NUMBER_OR_ZERO, NonNegative
from tissue.files.keys import KeyFacts
from tissue.files.sections import ParameterSection
from tissue.plugins import Force, registered


class ForcesSection(ParameterSection):
    """[forces]: the strengths of forces that files in own.modules register, by their names.

    Forces of the thesis have theirs in [cell] and [rules]. A force whose strength is 0, or not given, is not called.
    """

    model_config = ConfigDict(frozen=True, extra="allow", validate_default=True)
    __pydantic_extra__: dict[str, NonNegative]

    @classmethod
    def further_keys(cls) -> tuple[KeyFacts, ...]:
        """Return the keys of all registered forces."""
        plain = NUMBER_OR_ZERO.unit, NUMBER_OR_ZERO.allowed
        return tuple(
            KeyFacts(f"forces.{one.name}", one.meaning, "", one.source, *plain, 0) for one in registered(Force)
        )

    @model_validator(mode="after")
    def _note_forces(self, info: ValidationInfo) -> ForcesSection:
        """Note the strengths."""
        if info.context is not None:
            info.context.update({(ForcesSection, name): strength for name, strength in self})
        return self

    def acting(self) -> tuple[tuple[Force, float], ...]:
        """Return the forces whose strength is not 0, with the strength, in the order of their names."""
        known = {force.name: force for force in registered(Force)}
        return tuple((known[name], strength) for name, strength in sorted(self) if strength > 0)
