"""Statistics of EMT cells: ratios with intervals, differences, categories, curves, rankings. They take tables alone."""
