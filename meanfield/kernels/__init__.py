"""Compiled loops on plain arrays; each has a plain NumPy twin in :mod:`meanfield.kernels.twins`."""
