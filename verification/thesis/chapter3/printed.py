"""Values printed in Tables 2 to 4 and section 3.1 of chapter 3."""

# Table 2: soft radius [μm]; phases [h]; stiffnesses.
R_SOFT = 5.0
G2, MITOSIS = 0.5, 0.5
AA, AX, XX, AXB = 5.0, 2.0, 1.0, 15.0
# Table 3: time step [h], substeps.
DT, SUBSTEPS = 0.1, 20
# Table 4.
ALPHA, BETA, GAMMA, C, EPS = 1e-4, 0.25, 1e-3, 2.0, 1e-6
# Section 3.1: iterations of DAHA in a step.
USUAL = 7500
