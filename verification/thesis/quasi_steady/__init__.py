"""The quasi-steady model: what finds the minima of the energy, and the runs made of these."""
