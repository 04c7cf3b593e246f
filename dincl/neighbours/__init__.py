"""Pairs of discs that are near each other: searches, and lists that serve several sweeps."""
