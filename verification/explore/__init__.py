"""The page to explore: parameters on the left, the tissue or the particles in motion, and the answer on the right."""
