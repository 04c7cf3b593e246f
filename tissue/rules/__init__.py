"""What differs between a slice, a sheet and a closed surface."""
