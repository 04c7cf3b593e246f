"""The events of the epithelial-to-mesenchymal transition (section 2.2 of chapter 4), one in each file.

A file of an event has an ``EmtEvent`` called EVENT: its key in parameter files, and what it does to a cell when it
begins and in each dt after. ``tissue.events.known`` finds the files; nothing else knows of single events. Those of
one's own are registered, see ``tissue.register``.
"""
