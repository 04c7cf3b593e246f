"""The introduction of the thesis."""
