"""Parameter files: quantities with units, what each value may be, and which values go together."""
