"""What the daemon knows of its loops and connections at a moment, as values."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import Literal

from agent.alarms import State
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.results import Oscillation
from agent.runtime.link.connection import Connection
from agent.runtime.link.outbox import Outbox
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.operate.plan import silence
from agent.runtime.supervisor import Health
from agent.settings import Settings

Data = Literal["fresh", "stale", "none"]
"""none: nothing came in yet, and it is not time yet to call that stale."""


@dataclass(frozen=True, slots=True)
class LoopStatus:
    """What is known of a loop."""

    loop: str
    connection: str
    """That it is read from."""
    bus: str
    """Kind of that connection."""
    data: Data
    """Whether anything came in within `agent.data_age`, 5 sampling times or `hold`, whichever is longest."""
    samples: int
    gaps: int
    """Grid points without PV or OP in the newest window."""
    bad: int
    """Samples of bad quality."""
    odd_times: int
    """Samples whose source time was rejected."""
    superseded: int
    """Windows that were not diagnosed because a newer one came due."""
    busy: bool
    """Whether a window waits for its verdict."""
    data_age: float | None
    """Time since the newest sample arrived, s; None before the first."""
    verdict_age: float | None
    """Time since the newest verdict, s; None before the first."""
    oscillation: Oscillation | None
    diagnosis: Diagnosis | None
    alarm: State
    faults: int
    """Times the program failed on this loop."""
    problem: str
    """What the last fault was; empty where the loop works."""


@dataclass(frozen=True, slots=True)
class ConnectionStatus:
    """What is known of a connection."""

    connection: str
    bus: str
    up: bool
    losses: int
    """Times the peer was gone or did not answer."""
    faults: int
    """Times the program failed on it."""
    problem: str
    """Why it is down; empty where it is up."""
    waiting: int
    """Publications in the outbox."""
    refused: int
    """Publications that the peer refused, to be sent again."""
    oldest: float | None
    """Time that the oldest of both has waited, s; None where there is none."""
    dropped: int
    """Publications that were discarded because the outbox was full."""
    refusals: int
    """Attempts that were refused."""
    malformed: int
    """Messages that could not be read."""
    lost: int
    """Messages that were discarded because too many waited to be read."""


@dataclass(frozen=True, slots=True)
class AgentStatus:
    """What is known of the daemon as a whole."""

    loops: tuple[LoopStatus, ...]
    connections: tuple[ConnectionStatus, ...]
    hung: tuple[str, ...]
    """Hung tasks, e.g. ``connection unit1: open``: a fault of this program or of a library."""
    faults: int
    """Times the program failed on what is neither a loop nor a connection."""
    store_problem: str
    """Why the state file cannot be written now; empty where it can."""
    store_failures: int
    """Failed writes and reads of the state file."""
    history_dropped: int
    """Entries that the history lost because they could not be written."""
    orders_taken: int
    """Orders of people over the buses that changed an alarm."""
    orders_refused: int
    queued: int
    """Calculations that wait for a worker."""

    @property
    def ok(self) -> bool:
        """Whether all is well: nothing hangs, the state is kept, connections are up, loops have data."""
        return (
            not self.hung
            and not self.store_problem
            and all(each.up for each in self.connections)
            and all(each.data != "stale" for each in self.loops)
        )


def loop_status(pipeline: LoopPipeline, settings: Settings, health: Health) -> LoopStatus:
    """Look at a loop."""
    now = asyncio.get_running_loop().time()
    window, loop, diagnosis = pipeline.window, pipeline.settings, pipeline.diagnosis
    limit = max(silence(loop, settings.agent), loop.hold or 0.0)
    unusable = pipeline.usable.problem(now, pipeline.began, limit)
    apart, clock = window.clocks.apart, pipeline.intake.clock
    clocks = f"the clock of PV is {apart:.0f} s ahead of that of OP" if apart else ""
    return LoopStatus(
        loop=loop.name,
        connection=loop.connection,
        bus=settings.connections[loop.connection].kind,
        data="stale" if unusable is not None and pipeline.heard is not None else _data(pipeline, now, limit),
        samples=window.counters.samples,
        gaps=window.counters.missing,
        bad=window.counters.bad,
        odd_times=0 if clock is None else clock.absurd + clock.leaps,
        superseded=pipeline.superseded,
        busy=pipeline.busy,
        data_age=None if window.arrival is None else now - window.arrival,
        verdict_age=None if pipeline.judged_at is None else now - pipeline.judged_at,
        oscillation=None if diagnosis is None else diagnosis.oscillation,
        diagnosis=diagnosis,
        alarm=pipeline.alarm.state,
        faults=health.faults,
        problem=health.problem or (unusable or clocks if pipeline.heard is not None else ""),
    )


def connection_status(connection: Connection, outbox: Outbox, bus: str, now: float) -> ConnectionStatus:
    """Look at a connection at ``now``, s UTC."""
    health = connection.health
    return ConnectionStatus(
        connection=health.about["connection"],
        bus=bus,
        up=health.up,
        losses=health.losses,
        faults=health.faults,
        problem=health.problem,
        waiting=len(outbox),
        refused=len(outbox.refusals),
        oldest=None if outbox.oldest is None else max(now - outbox.oldest, 0.0),
        dropped=outbox.dropped + outbox.refusals.dropped,
        refusals=outbox.refusals.count,
        malformed=connection.malformed,
        lost=connection.lost,
    )


def _data(pipeline: LoopPipeline, now: float, limit: float) -> Data:
    since = pipeline.began if pipeline.heard is None else pipeline.heard
    if since is not None and now - since > limit:
        return "stale"
    return "none" if pipeline.heard is None else "fresh"
