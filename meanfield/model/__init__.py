"""Models, their derivatives, and the states from which runs start."""
