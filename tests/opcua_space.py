"""The standard address space of asyncua's servers, built once in a process: building takes over a second.

Each server gets nodes of its own. What they hold (values, references) is shared and never changed in place:
asyncua replaces the value of an attribute, and adds to or removes from the list of references.
"""

from __future__ import annotations

import functools
from pathlib import Path

from asyncua.server.address_space import AddressSpace, AttributeValue, NodeData
from asyncua.server.internal_server import InternalServer

_BUILD = InternalServer.load_standard_address_space
_BUILT: dict[str, list[NodeData]] = {}


def copied(node: NodeData) -> NodeData:
    """Return a node as it was built, without anything of a server."""
    other = NodeData(node.nodeid)
    other.attributes = {key: AttributeValue(each.value) for key, each in node.attributes.items()}
    other.references = list(node.references)
    return other


def nodes_of(space: AddressSpace) -> list[NodeData]:
    return [copied(space[key]) for key in space.keys()]  # noqa: SIM118 - it is no mapping


async def load(server: InternalServer, shelf_file: Path | None = None) -> None:
    """Fill the address space of a server: in place of ``InternalServer.load_standard_address_space``."""
    if shelf_file is not None or "standard" not in _BUILT:
        await _BUILD(server, shelf_file)
        if shelf_file is None:
            _BUILT["standard"] = nodes_of(server.aspace)
        return
    for node in _BUILT["standard"]:
        server.aspace[node.nodeid] = copied(node)


build_once = functools.partial(setattr, InternalServer, "load_standard_address_space", load)
