"""Chapter 2: first-order position based dynamics, its order, its speed and where methods fail."""
