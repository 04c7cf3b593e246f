"""Who is a neighbour of whom on a surface: an oriented triangulation whose edges never cross.

``start`` makes it of points; ``follow`` keeps it while they move, ``exchange`` exchanges neighbours, ``insert`` and
``remove`` are for cells that come and go.
"""
