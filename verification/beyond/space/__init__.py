"""The third dimension: what the tissue of chapters 3 and 4 does as a sheet instead of a slice."""
