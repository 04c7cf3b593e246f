"""Neighbours of cells in a layer in space: Delaunay's triangulation of its points.

``triangulation`` makes it on a plane, a cylinder or a sphere; ``neighbours`` renews it every few dt, and lets cells
come and go in between; ``lattice`` is where cells stand at the start.
"""
