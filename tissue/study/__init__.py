"""Studies: many replicates of scenarios of the EMT, their tables and their statistics."""
