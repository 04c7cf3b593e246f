"""Tissue on curved basal layers and in closed tubes."""
