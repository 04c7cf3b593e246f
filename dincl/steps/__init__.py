"""Time steps in compiled code: the loop over them, and the step of each scheme."""
