"""The event-driven solution: smooth motion with fixed active contacts, from one change of the contacts to the next."""
