"""Eight replicates at once: number k of a vector register belongs to replicate k, and what is done is the same for all.

Each replicate keeps a ``Store`` of its own, a row of the arrays of the batch, to which the rules of ``tissue.kernels``
are applied one replicate after the other. For the substeps between two updates of the rules positions and coefficients
are copied to a ``Board``, where the eight values of one cell are neighbours in memory.

No replicate knows of the others: what one of them needs less of is looked at in vain, without effect to the last bit.
"""
