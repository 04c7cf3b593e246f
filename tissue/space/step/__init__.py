"""The substeps of one dt in three dimensions, for a tissue alone: as ``tissue.step`` has them in two."""
