"""The appendix of the thesis."""
