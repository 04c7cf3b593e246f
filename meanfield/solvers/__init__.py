"""Solvers of the equations of motion, one method per module, and modules that they share."""
