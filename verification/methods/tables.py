"""The tables that claims of chapter 2 read, and what makes each."""

from verification.claims import Table

PAGE = "verification.methods.page"
REFERENCES = Table("references", f"{PAGE}:refer")
ORDERS, FITS = (Table(name, f"{PAGE}:converge") for name in ("orders", "order_fits"))
PENALTY_SCAN, PENALTY_BEST = (Table(name, f"{PAGE}:overlap") for name in ("penalty_scan", "penalty_best"))
LARGE_STEPS = Table("large_steps", f"{PAGE}:stride")
