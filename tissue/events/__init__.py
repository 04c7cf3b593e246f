"""Events of the epithelial-to-mesenchymal transition (section 2.2 of chapter 4), one in each file.

A file of an event has an ``EmtEvent`` called EVENT: its key in parameter files, and its effect on a cell when it begins
and in each dt after. ``tissue.events.known`` lists them. User-defined events are registered, see ``tissue.register``.
"""
