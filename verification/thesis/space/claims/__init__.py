"""Claims of the thesis on three dimensions: it makes none that a number decides."""
