"""Ports that are listened to again at once after a restart, and that nobody else takes over."""

from __future__ import annotations

import socket


def listen_again(listener: socket.socket) -> None:
    """Set the option that does so: SO_REUSEADDR lets another program of Windows take the port over."""
    exclusive = getattr(socket, "SO_EXCLUSIVEADDRUSE", None)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR if exclusive is None else exclusive, 1)
