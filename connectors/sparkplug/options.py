"""The Sparkplug part of the configuration file."""

from __future__ import annotations

from typing import Self

from pydantic import PrivateAttr

from connectors.mqtt.options import Broker, Level
from connectors.options import Target


class SparkplugOptions(Broker):
    """A Sparkplug B edge node on an MQTT broker; its devices are the loops that are published there."""

    group: Level = "slipjump"
    """Sparkplug's group id."""
    node: Level | None = None
    """Sparkplug's edge node id; no two nodes of a group may have the same. None: the computer's name."""
    orders: bool = False
    """Whether a host may acknowledge, shelve and so on by a command (DCMD)."""
    _guest: bool = PrivateAttr(default=False)

    @property
    def is_guest(self) -> bool:
        """Whether this only looks: no birth, no death, no command."""
        return self._guest

    def as_guest(self) -> Self:
        """Return the options of somebody who only looks."""
        guest = self.model_copy()
        guest._guest = True  # noqa: SLF001 - it is one of ours
        return guest


class SparkplugTarget(Target):
    """A loop as a device of the edge node."""

    device: Level | None = None
    """Sparkplug's device id. None: the loop's name."""
