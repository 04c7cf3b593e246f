"""Compiled code: programs of a model, rates of a measure of particles, steps of both integrators."""
