"""Kernels of networks, called as other kernels call them: with the addresses of the surface and of the network.

Called with the named tuples themselves, each would be compiled a second time.
"""

from dincl.compiled.structs import StructPointer, struct_type
from tissue.network import exchange
from tissue.network import follow as following
from tissue.network import insert as inserting
from tissue.network import remove as removing

_kinds = {}


def by_address(kernel):
    """The kernel, for the surface and the network as named tuples."""

    def call(surface, network, *others):
        return kernel(pointer(surface), pointer(network), *others)

    return call


def pointer(value):
    """The named tuple in memory; its type is found once, which takes longer than most calls."""
    if type(value) not in _kinds:
        _kinds[type(value)] = struct_type(value)
    return StructPointer(value, _kinds[type(value)])


follow = by_address(following.follow)
insert = by_address(inserting.insert)
relax = by_address(exchange.relax)
remove = by_address(removing.remove)
