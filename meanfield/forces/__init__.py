"""Effective mass and force of a measure of particles, and the interaction of its particles."""
