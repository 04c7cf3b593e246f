"""The events of the epithelial-to-mesenchymal transition (section 2.2 of chapter 4), one in each file.

Each event has a bit in ``Cells.events``, a kernel ``begin`` for the step at which it happens, and where it lasts a
kernel for each dt after. It fires in the step dt that ends at its time, or in which its time lies, and acts from the
beginning of that step. ``tissue.events.together`` calls the events; a new one is a new file and its lines there.
"""
