"""Iterations or smaller steps: PBD and XPBD at equal cost."""
