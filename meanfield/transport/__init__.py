"""Wasserstein distance W1 between points and densities."""
