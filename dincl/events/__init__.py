"""The event-driven solution: smooth motion on fixed contacts, from one change of the contacts to the next."""
