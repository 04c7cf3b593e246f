"""Chapter 1: differential inclusions with normal cones, and the geometry of the feasible set."""
