"""The tables that claims of chapter 2 read, and what makes each."""

from verification.claims import Table

PAGE = "verification.methods.page"
REFERENCES = Table("references", f"{PAGE}:refer")
ORDERS, FITS = (Table(name, f"{PAGE}:converge") for name in ("orders", "order_fits"))
PENALTY_BEST = Table("penalty_best", f"{PAGE}:overlap")
LARGE_STEPS = Table("large_steps", f"{PAGE}:stride")
