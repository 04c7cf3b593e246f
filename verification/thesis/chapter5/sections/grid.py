"""The PDE on grids."""

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import figures, grid_order
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.sections.words import form, listed, named

ORDERS = {
    "model": "Model",
    "finest": "Cells per axis",
    "order_error_f": "Order of f in L1 [95 %]",
    "order_error_w1": "of W1",
    "order_error_y": "of y",
    "least_error_f": "Least error of f",
    "least_error_y": "of y",
    "mass": "Error of the mass",
    "least": "Least f",
}
RUNS = {
    "model": "Model",
    "cells": "Cells",
    "error_f": "f in L1",
    "error_w1": "W1",
    "error_y": "y",
    "error_moment": "Second moment",
    "mass": "Mass",
}


def _run(context: Context) -> None:
    table = grid_order.study(context.full).complete(context.folder, context.executor)
    context.tables["meanfield_grid"] = table
    context.keep("meanfield_grid_orders", grid_order.orders(table))


def _section(context: Context) -> Section:
    table, orders = context.tables["meanfield_grid"], context.tables["meanfield_grid_orders"]
    picture = context.draw("meanfield_grid", figures.grid, table)
    return Section(
        "The PDE (5.42) against characteristics",
        [
            Text(_words(orders)),
            Picture(picture, "Errors at the end against the width of a cell; the uniform density has jumps."),
            Grid(named(orders, ORDERS), "Orders with 95 % intervals.", "meanfield_grid_orders"),
            Grid(named(table, RUNS), "All grids.", form("meanfield_grid", context.full), folded=True),
        ],
    )


def _words(orders: pd.DataFrame) -> str:
    smooth, jumps = orders[orders["smooth"]], orders[~orders["smooth"]]
    told = listed([f"{TITLES[row.model]} {row.order_error_f}" for row in smooth.itertuples()])
    rough = listed([f"{row.order_error_f}, and W1 with {row.order_error_w1}" for row in jumps.itertuples()])
    apart = orders["moments_apart"].max()
    return (
        "The density at the end is known exactly, carried by g(x, y) = const. For a smooth density the finite volumes "
        f"converge in L1 with order {told}; with jumps with {rough}. The mass is kept to "
        f"{number(orders['mass'].max())}, the least average is {number(orders['least'].min())}. Where moments close "
        f"they give the y of the characteristics, apart by at most {number(apart)} at tol = {number(grid_order.EXACT)}."
    )


PART = Part(_run, _section)
