"""Rules that differ between a slice, a sheet and a closed surface."""
