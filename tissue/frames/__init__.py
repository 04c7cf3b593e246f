"""The tissue at one time: saved states, their measurements, and sections through them."""
