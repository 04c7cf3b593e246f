"""Measurements beyond the thesis: better schemes, proofs, moving sets, curved layers, three dimensions."""
