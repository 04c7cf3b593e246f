"""Compiled loops on plain arrays: ``finite_volume`` with its NumPy twin in ``twins``, ``trig`` for generated loops."""
