"""The tables that claims of chapter 3 read, and what makes each."""

from verification.claims import Table


def _tables(section: str, names: str) -> tuple[Table, ...]:
    """Return tables that one section of the page makes."""
    made_by = f"verification.thesis.chapter3.sections.{section}:PART.run"
    return tuple(Table(f"tissue_{name}", made_by) for name in names.split())


DAHA, ITERATIONS, DISTANCES, SPEED, FITS, SHARES = _tables(
    "daha", "daha daha_iterations daha_distances daha_speed daha_fits daha_shares"
)
RATIOS, DOUBLING = _tables("growth", "ratios doubling")
(JUDGED_STEPS,) = _tables("judged", "judged_steps")
SPACE_HEIGHTS = Table("space_heights", "verification.beyond.space.sections.page:grow")
