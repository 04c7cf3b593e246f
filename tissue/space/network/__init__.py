"""Who is a neighbour of whom on a surface: an oriented triangulation whose edges never cross, see ``state``.

``start`` makes it of points; ``follow`` keeps it while they move, ``relax`` exchanges neighbours, ``insert`` and
``remove`` are for cells that come and go.
"""
