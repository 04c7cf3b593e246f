"""Figures and the page of a study, from its stored tables."""
