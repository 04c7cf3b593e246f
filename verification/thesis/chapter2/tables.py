"""The tables that claims of chapter 2 read, and what makes each."""

from verification.claims import Table

PAGE = "verification.thesis.chapter2.page"
POSITIONS = Table("positions", f"{PAGE}:solve")
REFERENCES = Table("references", f"{PAGE}:extrapolate")
CONVERGENCE, ORDERS = (Table(name, f"{PAGE}:converge") for name in ("convergence", "orders"))
PENALTY_SCAN, PENALTY_BEST = (Table(name, f"{PAGE}:overlap") for name in ("penalty_scan", "penalty_best"))
LARGE_STEPS = Table("large_steps", f"{PAGE}:stride")
