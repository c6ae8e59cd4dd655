"""Reports the state of the service to systemd: ready, alive, reloading, stopping.

One datagram each to the socket that ``NOTIFY_SOCKET`` names (sd_notify(3)); without systemd nothing is sent.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass

from agent.runtime.capabilities import notification_socket

LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class ServiceManager:
    """The service manager that started this process and waits for its notifications."""

    address: str | None = None
    """Address of its socket; None without a service manager."""
    watchdog: float | None = None
    """s within which it expects a sign of life, or it kills and restarts; None without a watchdog."""

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
        self._send("READY=1", f"STATUS={status}")

    def alive(self) -> None:
        """Say that it lives."""
        self._send("WATCHDOG=1")

    def reloading(self) -> None:
        """Say that the configuration is read anew; ``ready`` follows."""
        self._send("RELOADING=1", f"MONOTONIC_USEC={time.monotonic_ns() // 1000}")

    def stopping(self) -> None:
        """Say that it ends."""
        self._send("STOPPING=1")

    def _send(self, *lines: str) -> None:
        if self.address is None:
            return
        # "@" stands for the zero byte of a socket that has no file
        address = "\0" + self.address[1:] if self.address.startswith("@") else self.address
        manager = notification_socket()
        if manager is None:
            return
        try:
            with manager:
                manager.sendto("\n".join(lines).encode(), address)
        except OSError as error:
            LOG.debug("cannot send %s to systemd: %s", lines[0], error)
