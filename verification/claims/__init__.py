"""The claims, one file for each part of a chapter."""
