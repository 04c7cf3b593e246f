"""Densities of the particles: given by a function, or piecewise polynomial."""
