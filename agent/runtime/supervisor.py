"""Keeps tasks alive that must never end: counts failures, waits, restarts.

The one place of the program that may catch every exception: an unforeseen fault must cost one attempt and a
line in the log, never the loop behind it.
"""

from __future__ import annotations

import asyncio
import logging
import random
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass, field
from typing import Any, NoReturn, TypeVar

from connectors.base import AccessDeniedError, ConnectionLostError
from connectors.cancellation import obey_cancellation

LOG = logging.getLogger(__name__)
FIRST_WAIT = 0.1
"""s; doubles with each attempt that fails."""
LONGEST_WAIT = 3.0
"""s, unless the configuration sets another."""
LASTED = 10.0
"""Time after which a failed attempt still counts as a success, s: waits start small again."""
MARGIN = 30.0
"""Time beyond the agreed limit that a busy machine may need before a task counts as hung, s."""
E = TypeVar("E", bound=Exception)


@dataclass(slots=True)
class Health:
    """State of a supervised task."""

    name: str
    up: bool = False
    """Whether it works now."""
    losses: int = 0
    """Times the peer was unreachable or did not answer."""
    faults: int = 0
    """Unexpected errors."""
    attempts: int = 0
    """Consecutive failed attempts."""
    worked: bool = False
    """Whether the present attempt ever worked."""

    problem: str = ""
    """Present problem, as last logged."""
    logged: set[bool] = field(default_factory=set)
    """Losses logged since it last worked: False, the peer is gone; True, the peer denies access."""
    about: Mapping[str, str] = field(default_factory=dict)
    """Fields for the log: {"connection": NAME} or {"loop": NAME}."""
    signs: dict[str, float] = field(default_factory=dict)
    """Step in progress -> its deadline, s of the event loop's clock."""

    def expect(self, sign: str, within: float | None) -> None:
        """Set a deadline for ``sign`` in so many seconds; None removes it."""
        if within is None:
            self.signs.pop(sign, None)
        else:
            self.signs[sign] = asyncio.get_running_loop().time() + within

    def overdue(self, now: float) -> str | None:
        """Return a sign whose deadline passed before ``now`` (s of the event loop's clock), or None."""
        return next((sign for sign, due in self.signs.items() if due < now), None)

    def count_on(self, former: Health) -> None:
        """Continue the counters of the task that this one replaces."""
        self.losses += former.losses
        self.faults += former.faults

    def works(self) -> None:
        """Note that it works; logged if it did not before."""
        self.worked = True
        if not self.up:
            self.up, self.problem = True, ""
            self.logged.clear()
            LOG.info("%s is up", self.name, extra={"event": "up", **self.about})

    def lost(self, error: ConnectionLostError) -> None:
        """Note the loss of its peer; logged once, until the peer is back.

        Denied access is logged even if the peer was gone before: it does not resolve by itself.
        """
        self.losses += 1
        denied = isinstance(error, AccessDeniedError)
        if denied not in self.logged:
            self.logged.add(denied)
            self.problem = str(error)
            LOG.warning("%s is down: %s", self.name, error, extra={"event": "down", **self.about})
        self._failed()

    def failed(self, error: Exception) -> None:
        """Note an unexpected error; logged with its traceback, once while it is the same."""
        self.faults += 1
        if self.problem != repr(error):
            self.problem = repr(error)
            LOG.error(
                "%s failed, which is a fault of this program",
                self.name,
                exc_info=error,
                extra={"event": "fault", **self.about},
            )
        self._failed()

    def _failed(self) -> None:
        self.up = False
        self.attempts += 1


async def keep_alive(
    work: Callable[[], Coroutine[Any, Any, object]],
    health: Health,
    longest_wait: float = LONGEST_WAIT,
    uniform: Callable[[float, float], float] = random.uniform,
) -> NoReturn:
    """Run ``work`` again and again until cancelled.

    Between attempts it waits a random time of up to 0.1 s, 0.2 s, 0.4 s, ..., ``longest_wait`` (full jitter),
    so that many clients of a restarted server do not all reconnect at once. Time in which an attempt waited
    for a peer that never answered counts as waiting time.
    """
    clock = asyncio.get_running_loop()
    while True:
        began, health.worked = clock.time(), False
        health.signs.clear()
        try:
            # A task of its own: in Python 3.11 a TaskGroup that fails leaves its task marked as cancelled.
            await asyncio.create_task(work(), name=health.name)
            health.lost(ConnectionLostError("it ended"))
        except* ConnectionLostError as group:
            health.lost(_first(group))
        except* Exception as group:  # noqa: BLE001  # see the top of this file
            health.failed(_first(group))
        obey_cancellation()
        if clock.time() - began > LASTED:
            health.attempts = 1
        longest = min(FIRST_WAIT * 2 ** min(health.attempts - 1, 20), longest_wait)
        health.signs.clear()
        health.expect("the next attempt", longest + MARGIN)
        waited = 0.0 if health.worked else clock.time() - began
        await asyncio.sleep(max(uniform(0, longest) - waited, 0.0))


def _first(group: BaseExceptionGroup[E]) -> E:
    """Return the exception itself, out of the groups that a TaskGroup put around it."""
    error = group.exceptions[0]
    return _first(error) if isinstance(error, BaseExceptionGroup) else error
