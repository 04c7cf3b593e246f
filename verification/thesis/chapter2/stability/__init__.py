"""Where methods fail: planes of step and one other thing, and single cases with a limit known from theory."""
