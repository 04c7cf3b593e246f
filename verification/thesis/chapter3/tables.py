"""The tables that claims of chapter 3 read, and what makes each."""

from verification.claims import Table

PAGE = "verification.thesis.chapter3.page"
DAHA, ITERATIONS, DISTANCES, SPEED, FITS, SHARES = (
    Table(name, f"{PAGE}:compare")
    for name in (
        "tissue_daha",
        *(f"tissue_daha_{one}" for one in ("iterations", "distances", "speed", "fits", "shares")),
    )
)
RATIOS, DOUBLING = (Table(name, f"{PAGE}:grow") for name in ("tissue_ratios", "tissue_doubling"))
JUDGED_STEPS = Table("tissue_judged_steps", f"{PAGE}:judge")
SPACE_HEIGHTS = Table("space_heights", "verification.tissues.space.page:grow")
