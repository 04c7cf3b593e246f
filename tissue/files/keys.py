"""Description of a key of a parameter file, and where to look it up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, Field

# In place of a default: the key has to be given.
NOTHING: Any = ...


def key(meaning: str, symbol: str = "", source: str = "", default: Any = NOTHING) -> Any:
    """Make the field of a section for one key.

    Parameters
    ----------
    meaning
        In a few words, as they stand in a comment behind the value.
    symbol
        In the thesis, if it has one: "h^init", "alpha^ax".
    source
        Where the thesis has it, or the row of the table of model variants.
    default
        As in a file, and checked as a value from there. Without it the key has to be given.
    """
    return Field(default, description=meaning, json_schema_extra={"symbol": symbol, "source": source})


@dataclass(frozen=True)
class KeyFacts:
    """All that is known of a key; ``name`` is such as "tissue.cells", ``default`` as in a file, NOTHING for none.

    ``options`` are all values that are allowed, where these are a few.
    """

    name: str
    meaning: str
    symbol: str
    source: str
    unit: str
    allowed: str
    default: Any
    options: tuple[Any, ...] = ()

    @property
    def section(self) -> str:
        """Where it stands in a file."""
        return self.name.partition(".")[0]

    @property
    def has_default(self) -> bool:
        """Whether a file without base may leave it out."""
        return self.default is not NOTHING

    @property
    def comment(self) -> str:
        """Symbol and meaning, as behind a value in a file."""
        return f"{self.symbol}: {self.meaning}" if self.symbol else self.meaning

    @property
    def is_choice(self) -> bool:
        """Whether a few values are all that is allowed; they stand for their unit, too."""
        return bool(self.options)


def all_keys(shape: type[BaseModel]) -> dict[str, KeyFacts]:
    """Return the keys of all sections by name, in the order of a file."""
    found: dict[str, KeyFacts] = {}
    for section, fields in sections(shape).items():
        found |= {
            f"{section}.{name}": facts_of(f"{section}.{name}", field) for name, field in fields.model_fields.items()
        }
        found |= {facts.name: facts for facts in fields.further_keys()}
    return found


def sections(shape: type[BaseModel]) -> dict[str, Any]:
    """Return the model of each section, by its name."""
    return {name: field.annotation for name, field in shape.model_fields.items()}


def optional_sections(shape: type[BaseModel]) -> dict[str, dict[str, Any]]:
    """Return an empty table for each section that a file may leave out."""
    found = sections(shape)
    return {name: {} for name in found if not any(one.is_required() for one in found[name].model_fields.values())}


def heading(fields: type[BaseModel]) -> str:
    """Return the heading of a section, the first line of its docstring."""
    return (fields.__doc__ or "").partition("]: ")[2].partition("\n")[0]


def facts_of(name: str, field: Any) -> KeyFacts:
    """Read from the field of a section what is known of its key."""
    check = field.metadata[0]
    default = NOTHING if field.is_required() else field.default
    return KeyFacts(
        name,
        field.description,
        **field.json_schema_extra,
        unit=check.unit,
        allowed=check.allowed,
        default=default,
        options=check.options,
    )
