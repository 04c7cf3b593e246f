"""The tissue in three dimensions, measured."""
