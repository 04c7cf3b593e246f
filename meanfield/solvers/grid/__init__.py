"""Finite volumes for the mean-field PDE on a fixed grid."""
