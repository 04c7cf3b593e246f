"""What a measure of particles does to the macroscopic component, and its particles to each other."""
