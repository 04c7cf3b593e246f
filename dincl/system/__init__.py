"""A problem as compiled code sees it: rows, drift and sets by their addresses, in units of its own."""
