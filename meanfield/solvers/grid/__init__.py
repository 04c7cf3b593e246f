"""The mean-field PDE on a grid that stays where it is."""
