"""Where methods fail: maps over the step and another parameter, and single cases with a limit known from theory."""
