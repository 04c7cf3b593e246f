"""Values printed in Tables 1 to 5 and section 3.1 of chapter 3."""

# Table 1: height and width at the start [μm], number of cells, distance of their apical points [μm].
HEIGHT, WIDTH, CELLS, SPACING = 50.0, 40.0, 60, 1.66
# Table 2: soft and hard radius [μm], the enlarged one over R^soft; phases and cycles [h]; stiffnesses.
R_SOFT, HARD, ENLARGED = 5.0, 1.66, 0.7
G2, MITOSIS, SHORTEST, LONGEST = 0.5, 0.5, 10.0, 21.0
AA, AX, BX, XX, AXB = 5.0, 2.0, 2.0, 1.0, 15.0
# Tables 3 and 5: time step, damping [h], substeps.
DT, MU, SUBSTEPS = 0.1, 0.15, 20
# Table 4.
ALPHA, BETA, GAMMA, C, EPS = 1e-4, 0.25, 1e-3, 2.0, 1e-6
# Section 3.1: iterations of DAHA in a step.
USUAL = 7500
