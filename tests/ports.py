"""Ports of loopback for servers of tests."""

import contextlib
import random
import socket

NOT_FOR_CONNECTIONS = 20_000, 32_768
"""From which Linux gives none to an outgoing connection."""


def free_port():
    """A port for a server, now or again, which no connection of another test may take meanwhile."""
    while True:
        port = random.SystemRandom().randrange(*NOT_FOR_CONNECTIONS)
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
