"""The events that have begun, as bits of ``Cells.events``."""

A = 1  # loss of apical adhesion
B = 2  # loss of basal adhesion
S = 4  # loss of straightness
P = 8  # protrusions
