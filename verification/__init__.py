"""Convergence orders, tables and the report: what the schemes do, measured against what is known."""
