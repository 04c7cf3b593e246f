"""Densities of the particles, given by a function or as a piecewise polynomial."""
