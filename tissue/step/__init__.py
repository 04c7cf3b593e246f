"""One step dt: rules, substeps, and the addresses by which compiled code is called."""
