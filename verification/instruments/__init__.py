"""Instruments for any problem: orders, speed against accuracy, stability, rates, references."""
