"""Solvers of least-distance programs in compiled code, and the factors that they use."""
