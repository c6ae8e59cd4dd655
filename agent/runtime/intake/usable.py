"""Whether the values of a loop can be used: one without a usable PV or OP is not healthy."""

from __future__ import annotations

import logging
import math
from typing import TYPE_CHECKING

from connectors.base import Quality

if TYPE_CHECKING:
    from collections.abc import Sequence

    from connectors.base import Sample

LOG = logging.getLogger(__name__)
NEEDED = ("pv", "op")
"""Roles without which nothing can be judged."""
LOGGED_AGAIN = 3600.0
"""Time after which another bad value of the same role is logged, s: a transmitter may flap."""


class UsableValues:
    """Follows which of the needed roles have a usable newest value."""

    def __init__(self, loop: str) -> None:
        """Begin without any value."""
        self.loop = loop
        self._since: dict[str, float] = {}
        self._why = dict.fromkeys(NEEDED, "no value came")
        self._logged: dict[str, float] = {}

    def see(self, sample: Sample, arrival: float) -> None:
        """Take a sample that arrived at ``arrival`` (monotonic, s)."""
        role = sample.tag.role
        if role not in NEEDED:
            return
        value = sample.value
        if sample.quality is not Quality.BAD and not isinstance(value, str) and math.isfinite(value):
            if self._why:
                self._why.pop(role, None)
                self._since.pop(role, None)
            return
        self._why[role] = sample.why or f"quality {sample.quality.name.lower()}, code {sample.code:#x}"
        self._since.setdefault(role, arrival)
        if arrival - self._logged.get(role, -math.inf) >= LOGGED_AGAIN:
            self._logged[role] = arrival
            text = "%s: %s cannot be used: %s"
            LOG.warning(
                text, self.loop, role.upper(), self._why[role], extra={"event": "bad", "loop": self.loop}
            )

    def well(self, roles: Sequence[str]) -> bool:
        """Whether values of these roles that can be used change nothing."""
        return not self._why or self._why.keys().isdisjoint(roles)

    def problem(self, now: float, began: float | None, limit: float) -> str | None:
        """Return which role had no usable value for longer than ``limit`` s, and why; None where none.

        Args:
            now: Monotonic time, s.
            began: When the loop began; None: not yet.
            limit: s.
        """
        for role, why in self._why.items():
            since = self._since.get(role, began)
            if since is not None and now - since > limit:
                return f"{role.upper()} had no usable value for {now - since:.0f} s: {why}"
        return None
