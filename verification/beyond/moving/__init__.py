"""Scenes whose sets turn, close and grow."""
