"""The third dimension: the tissue of chapters 3 and 4 as a sheet instead of a slice."""
