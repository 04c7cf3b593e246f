"""Which method when: convergence, stability, speed against accuracy, moving sets; studies by the instruments."""
