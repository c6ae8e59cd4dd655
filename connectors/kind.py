"""A registered bus."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from connectors.base import Connector
from connectors.options import LoopTags, Options, TagT, TargetT

if TYPE_CHECKING:
    from connectors.checks.peer import PeerFactory

OptionsT = TypeVar("OptionsT", bound=Options)
ROLES = ("pv", "op", "sp", "mv", "mode")
"""Roles of a tag in its loop."""


@dataclass(frozen=True, slots=True)
class ConnectorKind(Generic[OptionsT, TagT, TargetT]):
    """A bus: the models of its part of the configuration file, and how a connection is made of them."""

    kind: str
    """``kind`` of an entry in ``connections``."""
    options: type[OptionsT]
    """The entry's other keys."""
    tag: type[TagT]
    """One entry of a loop's ``tags``."""
    target: type[TargetT]
    """One entry of a loop's ``publish``."""
    open: Callable[[str, OptionsT, Mapping[str, LoopTags[TagT, TargetT]]], Connector]
    """Connection name, its options, loop name -> what it reads and writes there. Opens nothing yet."""
    roles: tuple[str, ...] = ROLES
    """Keys allowed in a loop's ``tags``; empty where nothing is read from it, with ``NoTag`` as ``tag``."""
    short: Callable[[str], Mapping[str, str]] | None = None
    """Returns an address that is one text, as lists of loops have it, as an entry of ``tags``."""
    listens: bool = False
    """Whether the connector is a server; otherwise it connects to a peer."""
    peers: PeerFactory | None = None
    """Factory of the peer that ``connectors.checks`` runs it against. Those of the kinds built in are in
    ``simulators.servers.peers``, as connectors import no simulator."""
