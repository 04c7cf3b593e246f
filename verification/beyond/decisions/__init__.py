"""Decisions: whether ``Auto`` keeps its promise on random scenes, and a tree that says which method to take."""
