"""Hard scenes: contacts that begin, end or depend on each other all at once, for every method."""
