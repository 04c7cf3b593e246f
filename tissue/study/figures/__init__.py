"""The counterparts of Figures 10 to 22 of chapter 4, from the stored tables of studies."""
