"""Decisions: whether ``Auto`` keeps its promise on random scenes, and how often each method is the cheapest."""
