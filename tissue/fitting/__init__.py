"""Fits: parameters with ranges, a design of runs, an emulator of what they give, and what data say about them."""
