"""What a connector must do, as functions: ``check(kind, peers)`` raises AssertionError with one sentence.

Our own tests run ``checks_of(kind)`` for every registered kind, and so can anybody who brings a connector:
docs/howto/own_connector.md.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from connectors.checks.garbage import clients_may_send_garbage, garbage_is_a_loss
from connectors.checks.listening import a_port_in_use_is_reported
from connectors.checks.losses import (
    a_lost_peer_is_reported,
    a_silent_peer_is_reported,
    nobody_there_is_reported,
    nothing_is_lost_after_a_reconnect,
    opening_ends_when_cancelled,
)
from connectors.checks.peer import LOOPS, ROLES, Entry, Peer, PeerFactory
from connectors.checks.publishing import an_alarm_comes_and_goes
from connectors.checks.reading import bytes_may_come_in_pieces, every_sample_arrives
from connectors.checks.session import Kind, Reader, connector_to
from connectors.checks.sessions import (
    nothing_opens_before_a_session,
    reading_ends_when_cancelled,
    sessions_follow_each_other,
)

__all__ = [
    "CONNECTING",
    "EVERY",
    "LISTENING",
    "LOOPS",
    "READING",
    "ROLES",
    "Check",
    "Entry",
    "Peer",
    "PeerFactory",
    "Reader",
    "checks_of",
    "connector_to",
]

Check = Callable[[Kind, PeerFactory], Awaitable[None]]
"""One requirement; its first line of documentation says what it requires."""

EVERY: tuple[Check, ...] = (
    nothing_opens_before_a_session,
    reading_ends_when_cancelled,
    sessions_follow_each_other,
    an_alarm_comes_and_goes,
)
"""For every kind."""
CONNECTING: tuple[Check, ...] = (
    nobody_there_is_reported,
    a_lost_peer_is_reported,
    a_silent_peer_is_reported,
    opening_ends_when_cancelled,
    nothing_is_lost_after_a_reconnect,
    garbage_is_a_loss,
)
"""For kinds that connect to a peer."""
LISTENING: tuple[Check, ...] = (a_port_in_use_is_reported, clients_may_send_garbage)
"""For kinds that are servers themselves."""
READING: tuple[Check, ...] = (every_sample_arrives, bytes_may_come_in_pieces)
"""For kinds from which values of loops are read."""


def checks_of(kind: Kind) -> tuple[Check, ...]:
    """Return the checks that apply to a kind."""
    return (*EVERY, *(LISTENING if kind.listens else CONNECTING), *(READING if kind.roles else ()))
