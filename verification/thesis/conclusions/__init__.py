"""The conclusions of the thesis."""
