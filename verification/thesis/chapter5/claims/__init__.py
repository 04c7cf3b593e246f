"""Statements of the text, one file for each part of it; file names begin with the section."""
