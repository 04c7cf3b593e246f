"""The tissue at one time: saved states, what is measured of them, and sections through them."""
