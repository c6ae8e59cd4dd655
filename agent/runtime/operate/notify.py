"""Tells systemd how the service fares: ready, alive, reloading, stopping.

One datagram each to the socket that ``NOTIFY_SOCKET`` names (sd_notify(3)); without systemd nothing happens.
"""

from __future__ import annotations

import logging
import os
import socket
import time
from collections.abc import Mapping
from dataclasses import dataclass

LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class ServiceManager:
    """Who started this process and waits for news."""

    address: str | None = None
    """Of its socket; None where nobody waits."""
    watchdog: float | None = None
    """s within which it wants a sign of life, or it kills and starts anew; None where it does not."""

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> ServiceManager:
        """Read what systemd left in the environment."""
        address = environment.get("NOTIFY_SOCKET", "")
        if not address.startswith(("/", "@")):
            return cls()
        for_us = environment.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
        microseconds = environment.get("WATCHDOG_USEC", "")
        watchdog = int(microseconds) / 1e6 if for_us and microseconds.isdigit() else None
        return cls(address, watchdog or None)

    def ready(self, status: str) -> None:
        """Say that it works, at start and after a reload; ``status`` is a line for ``systemctl status``."""
        self._tell("READY=1", f"STATUS={status}")

    def alive(self) -> None:
        """Say that it lives."""
        self._tell("WATCHDOG=1")

    def reloading(self) -> None:
        """Say that the configuration is read anew; ``ready`` follows."""
        self._tell("RELOADING=1", f"MONOTONIC_USEC={time.monotonic_ns() // 1000}")

    def stopping(self) -> None:
        """Say that it ends."""
        self._tell("STOPPING=1")

    def _tell(self, *lines: str) -> None:
        if self.address is None:
            return
        # "@" stands for the zero byte of a socket that has no file
        address = "\0" + self.address[1:] if self.address.startswith("@") else self.address
        kind = socket.SOCK_DGRAM | socket.SOCK_CLOEXEC | socket.SOCK_NONBLOCK
        try:
            with socket.socket(socket.AF_UNIX, kind) as manager:
                manager.sendto("\n".join(lines).encode(), address)
        except OSError as error:
            LOG.debug("systemd cannot be told %s: %s", lines[0], error)
