"""What every connector speaks: samples in, publications out, and the errors a caller can act on."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from enum import IntEnum
from typing import Literal, NamedTuple, Protocol, runtime_checkable

WITHDRAWN = "withdrawn"
"""Kind of a publication that ends all others of its subject."""
JsonValue = float | int | str | bool | None
Action = Literal["acknowledge", "shelve", "unshelve", "out_of_service", "in_service"]
"""Orders that an operator may give."""


class Quality(IntEnum):
    """Worth of a sample; the original code travels beside it."""

    GOOD = 0
    UNCERTAIN = 1
    BAD = 2


class LoopRole(NamedTuple):
    """Which value of which loop a sample is."""

    loop: str
    """Name of the loop."""
    role: str
    """One of pv, op, sp, mv, mode."""

    def __str__(self) -> str:
        """Return it as messages name it: ``LOOP.ROLE``."""
        return f"{self.loop}.{self.role}"


@dataclass(frozen=True, slots=True)
class Sample:
    """One value of one tag."""

    tag: LoopRole
    time: float
    """Source time, s UTC."""
    value: float | str
    """NaN where the source had none; text only for modes."""
    quality: Quality = Quality.GOOD
    code: int = 0
    """The bus's own status code (OPC UA status, Modbus exception), 0 where it has none."""
    why: str = ""
    """Why there is no value, or why its quality is not good, in words for people; empty where nobody says."""

    @classmethod
    def measured(
        cls,
        tag: LoopRole,
        time: float,
        value: float | str,
        quality: Quality = Quality.GOOD,
        code: int = 0,
        why: str = "",
    ) -> Sample:
        """Make a sample of what a source sent; text (but for modes), NaN and infinity count as missing."""
        if isinstance(value, str) and tag.role != "mode":
            return cls.missing(tag, time, code, f"the text {value[:40]!r} where a number belongs")
        if isinstance(value, float | int) and not math.isfinite(value):
            return cls.missing(tag, time, code, f"{value} where a number belongs")
        return cls(tag, time, value, quality, code, why)

    @classmethod
    def missing(cls, tag: LoopRole, time: float, code: int = 0, why: str = "") -> Sample:
        """Make the sample that says: here a value is missing."""
        return cls(tag, time, math.nan, Quality.BAD, code, why)


@dataclass(frozen=True, slots=True)
class Publication:
    """Something to publish about a subject; each bus maps the fields onto its own targets."""

    subject: str
    """Whom it is about, e.g. the loop's name."""
    kind: str
    """``state`` (the newest replaces the former), ``event`` (each counts), ``WITHDRAWN`` (it is not published
    any more, and what was published last must not stay there)."""
    id: str
    """Stable over retries: a consumer that honours it sees nothing twice."""
    fields: Mapping[str, JsonValue]

    @property
    def key(self) -> tuple[str, str]:
        """What it is one of: a later publication with the same key takes its place."""
        return ("event", self.id) if self.kind == "event" else ("state", self.subject)


@dataclass(frozen=True, slots=True)
class Order:
    """Order of an operator for a subject's alarm, over a bus."""

    subject: str
    """Whose alarm, e.g. the loop's name."""
    action: Action
    by: str
    """Operator, as far as the bus names one."""
    until: float | None = None
    """End of shelving, s UTC; None with every other action."""
    alarm: str | None = None
    """Id of the activation that is meant; None: whichever stands."""


class ConnectionLostError(Exception):
    """The peer is gone, refuses or stalls: wait and try again with a fresh session."""


class AccessDeniedError(ConnectionLostError):
    """The peer does not let us in, or is not who it should be: an operator must change something."""


class RefusedError(Exception):
    """The peer is there but will not take some of this publication: try that again later, and report it.

    All that it does take has been written.
    """


class ConfigError(Exception):
    """The user must change a file; carries every fault with its path, one a line."""

    def __init__(self, faults: list[str]) -> None:
        super().__init__("\n".join(faults))
        self.faults = faults


class Session(Protocol):
    """An open connection; used by one reader and one writer at a time."""

    def samples(self) -> AsyncIterator[Sample | Order]:
        """Yield what comes in for ever: samples, and orders where the connector takes them.

        Raises ConnectionLostError when the peer is gone.
        """
        ...

    async def publish(self, publication: Publication) -> None:
        """Hand over to the bus and return when the peer took it; raises ConnectionLostError, RefusedError.

        Nothing is written but what the configuration names for the publication's subject.
        """
        ...


@dataclass(frozen=True, slots=True)
class TargetReport:
    """Whether a target could be written, as far as that can be checked without writing."""

    subject: str
    place: str
    """In the bus's own words, e.g. ``coil 100``."""
    problem: str | None = None
    """Why it could not; None where nothing speaks against it."""
    remark: str = ""
    """What only writing would show."""


@runtime_checkable
class ChecksTargets(Protocol):
    """A session that can look at the places it publishes to."""

    async def check_targets(self) -> list[TargetReport]:
        """Look at each, without writing anything; raises ConnectionLostError."""
        ...


@runtime_checkable
class CountsMalformed(Protocol):
    """A connector that counts messages it could not read."""

    @property
    def malformed(self) -> int:
        """Of them since the start."""
        ...


@runtime_checkable
class CountsLost(Protocol):
    """A connector that counts messages it had to discard before they were read."""

    @property
    def lost(self) -> int:
        """Of them since the start."""
        ...


@runtime_checkable
class OpensSlowly(Protocol):
    """A connector whose sessions take their time to open, because there is much to build."""

    @property
    def opens_within(self) -> float:
        """Longest time for it, s."""
        ...


class Connector(Protocol):
    """A configured bus. Each ``session()`` is a fresh client; retrying is the supervisor's business."""

    @property
    def name(self) -> str:
        """Name of the connection in the configuration."""
        ...

    @property
    def takes_orders(self) -> bool:
        """Whether its sessions may yield orders: they are read then even if no loop is read there."""
        ...

    def session(self) -> AbstractAsyncContextManager[Session]:
        """Connect; raises ConnectionLostError where the peer cannot be reached in time, AccessDeniedError."""
        ...
