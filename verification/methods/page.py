"""The experiments of chapter 2 of the thesis, section 4, and orders on sets that move: tables and figures."""

from __future__ import annotations

from verification.claims import Table
from verification.methods import large_steps, orders, references, strengths
from verification.site.context import Context

# The tables that claims of chapter 2 read, and what makes each.
PAGE = "verification.methods.page"
REFERENCES = Table("references", f"{PAGE}:refer")
ORDERS, FITS = (Table(name, f"{PAGE}:converge") for name in ("orders", "order_fits"))
PENALTY_BEST = Table("penalty_best", f"{PAGE}:overlap")
LARGE_STEPS = Table("large_steps", f"{PAGE}:stride")


def run(context: Context) -> None:
    """Complete all studies of this page."""
    for complete in (refer, converge, overlap, stride):
        complete(context)


def refer(context: Context) -> None:
    """Compute the reference solutions, and the limits of both convergent methods."""
    context.rows("references")


def converge(context: Context) -> None:
    """Compare the methods with exact solutions, and estimate their orders."""
    context.keep("order_fits", orders.fits(context.rows("orders")))


def overlap(context: Context) -> None:
    """Look for the best strengths of penalty methods."""
    context.keep("penalty_best", strengths.best_strengths(context.rows("penalty_scan")))


def stride(context: Context) -> None:
    """Try large steps."""
    context.rows("large_steps")


def show(context: Context) -> None:
    """Give the two scenes with their reference, orders, overlap and large steps."""
    tables = context.tables
    rows, fits = tables["references"], tables["order_fits"]
    shown = rows[(rows["particle"] == 0) & (rows["t"] % 1 == 0) & (rows["t"] > 0)]
    context.draw("scenes", references.draw, rows)
    context.show("references", context.headed("references", shown))
    moving = [make().title for make in orders.MOVING]
    for make in orders.EXPERIMENTS:
        scene = make()
        panels = [(scene.title, error) for error in (*(f"t = {t:g}" for t in scene.times), "overlap")]
        context.draw(f"orders_{scene.name}", orders.draw, tables["orders"], panels)
    context.draw("orders_moving", orders.draw, tables["orders"], [(name, "largest") for name in moving])
    headed = fits[list(orders.HEADINGS)].rename(columns=orders.HEADINGS)
    moves = fits["problem"].isin(moving)
    context.show("orders", headed[~moves], "order_fits")
    context.show("orders_moving", headed[moves], "order_fits")
    context.draw("penalty_strengths", strengths.draw_scan, tables["penalty_scan"])
    context.show("penalty_best", context.headed("penalty_scan", tables["penalty_best"]))
    context.draw("large_steps", large_steps.draw, tables["large_steps"])
