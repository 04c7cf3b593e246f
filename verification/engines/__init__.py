"""For authors of engines: ten scenes with proved answers and a checker, and contact programs as quadratic programs."""
