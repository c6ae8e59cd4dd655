"""Metrics of the daemon for Prometheus. docs/howto/monitoring.md lists all of them."""

from __future__ import annotations

import functools
from collections import Counter as Count
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Iterator, Sequence
from importlib.metadata import version
from typing import Literal

from prometheus_client import CollectorRegistry, Counter, Histogram, ProcessCollector, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, InfoMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector
from prometheus_client.utils import floatToGoString

from agent.alarms import Announcement, State
from agent.analysis.indices import INDICES, PerformanceIndex
from agent.runtime.loop.judged import Judged
from agent.runtime.operate.breath import breathing
from agent.runtime.operate.status import AgentStatus, ConnectionStatus, LoopStatus

ValueOf = Callable[[LoopStatus], float | None]
LINES = 500
"""Lines that are written in one part."""
BUCKETS = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
"""s"""


def _band(status: LoopStatus, name: Literal["s", "j"]) -> float | None:
    """Return S or J of a loop's newest diagnosis; None where it has none."""
    found = None if status.diagnosis is None else status.diagnosis.quantification
    if found is None or found.stiction is None:
        return None
    return found.stiction.s.value if name == "s" else found.stiction.j.value


def _period(status: LoopStatus) -> float | None:
    seen = None if status.diagnosis is None else status.diagnosis.oscillation
    return seen.period if seen is not None and seen.detected else None


def _index(name: str, status: LoopStatus) -> float | None:
    return None if status.diagnosis is None else status.diagnosis.indices.get(name)


def _help(index: PerformanceIndex) -> str:
    sentence = index.meaning[0].upper() + index.meaning[1:]
    return f"{sentence}, {index.unit}" if index.unit else sentence


LOOP_GAUGES: tuple[tuple[str, str, ValueOf], ...] = (
    ("data_age_seconds", "Time since the newest sample arrived", lambda s: s.data_age),
    ("stale", "1 if no sample arrived for too long", lambda s: s.data == "stale"),
    ("gaps", "Grid points without PV or OP in the newest window", lambda s: s.gaps),
    ("verdict_age_seconds", "Time since the newest verdict", lambda s: s.verdict_age),
    ("waiting", "1 while a window waits for its verdict", lambda s: s.busy),
    ("alarm_active", "1 while the alarm is active", lambda s: s.alarm.active),
    (
        "s",
        "Stick band plus dead band S by the newest window, OP units",
        lambda s: _band(s, "s"),
    ),
    ("j", "Slip jump J by the newest window, OP units", lambda s: _band(s, "j")),
    ("period_seconds", "Period of the oscillation in the newest window", _period),
    (
        "probability",
        "Probability that the valve sticks, from the newest window",
        lambda s: None if s.diagnosis is None else s.diagnosis.probability,
    ),
    *((f"index_{each.name}", _help(each), functools.partial(_index, each.name)) for each in INDICES),
)
LOOP_COUNTERS: tuple[tuple[str, str, ValueOf], ...] = (
    ("samples", "Samples taken", lambda s: s.samples),
    ("bad_samples", "Samples of bad quality", lambda s: s.bad),
    ("odd_times", "Samples whose source time was rejected", lambda s: s.odd_times),
    ("superseded_windows", "Windows not diagnosed because a newer one came due", lambda s: s.superseded),
    ("faults", "Times the program failed on the loop", lambda s: s.faults),
)
CONNECTION_GAUGES: tuple[tuple[str, str, Callable[[ConnectionStatus], float | None]], ...] = (
    ("up", "1 while it works", lambda s: s.up),
    ("outbox_waiting", "Publications that wait for the peer", lambda s: s.waiting),
    ("outbox_refused", "Publications that the peer refused, to be sent again", lambda s: s.refused),
    ("outbox_oldest_seconds", "Time that the oldest of these has waited", lambda s: s.oldest or 0.0),
)
CONNECTION_COUNTERS: tuple[tuple[str, str, Callable[[ConnectionStatus], float]], ...] = (
    ("losses", "Times the peer was gone or did not answer; a new session follows each", lambda s: s.losses),
    ("faults", "Times the program failed on the connection", lambda s: s.faults),
    ("outbox_dropped", "Publications discarded because the outbox was full", lambda s: s.dropped),
    ("refusals", "Attempts to publish that the peer refused", lambda s: s.refusals),
    ("malformed", "Messages that could not be read, orders among them", lambda s: s.malformed),
    ("lost_messages", "Messages discarded because too many waited to be read", lambda s: s.lost),
)
AGENT_COUNTERS: tuple[tuple[str, str, Callable[[AgentStatus], float]], ...] = (
    ("faults", "Times the program failed on what is neither loop nor connection", lambda s: s.faults),
    ("store_failures", "Failed writes and reads of the state file", lambda s: s.store_failures),
    ("history_dropped", "Entries that the history lost", lambda s: s.history_dropped),
    ("orders_taken", "Orders of people over the buses that changed an alarm", lambda s: s.orders_taken),
    (
        "orders_refused",
        "Orders of people over the buses that were refused",
        lambda s: s.orders_refused,
    ),
)


class Metrics(Collector):
    """Reads the state of the daemon at each scrape, and counts verdicts as an observer of its loops."""

    def __init__(self, looked: Callable[[], Awaitable[AgentStatus]]) -> None:
        """Make them.

        Args:
            looked: Looks at the daemon; called at each scrape.
        """
        self._looked = looked
        self._status: AgentStatus | None = None
        """Of the scrape that is answered."""
        self._alarms: Count[State] = Count()
        """Of the same, by state."""
        self._verdicts: Count[tuple[str, str]] = Count()
        self._registry = CollectorRegistry()
        self._changes = Counter(
            "slipjump_alarm_changes", "Changes of alarms, by new state", ["state"], registry=self._registry
        )
        self._windows = Histogram(
            "slipjump_window_seconds",
            "Time from the end of a window to its verdict, waiting for a worker included",
            buckets=BUCKETS,
            registry=self._registry,
        )
        self._fits = Histogram(
            "slipjump_fit_seconds",
            "Time of a full diagnosis in its worker",
            buckets=BUCKETS,
            registry=self._registry,
        )
        self._registry.register(self)
        ProcessCollector(registry=self._registry)

    async def parts(self) -> AsyncIterator[bytes]:
        """Yield all of it in Prometheus' text format, a part at a time, so that others have their turn."""
        self._status = status = await self._looked()
        gauges = (
            _LoopMetric(f"slipjump_loop_{name}", "gauge", text, value_of)
            for name, text, value_of in LOOP_GAUGES
        )
        counters = (
            _LoopMetric(f"slipjump_loop_{name}_total", "counter", text, value_of)
            for name, text, value_of in LOOP_COUNTERS
        )
        rows = [*gauges, *counters]
        self._alarms = alarms = Count[State]()
        async for each in breathing(status.loops):
            alarms[each.alarm] += 1
            label = _escaped(each.loop)
            for row in rows:
                row.add(label, each)
        verdicts = _LoopMetric("slipjump_diagnoses_total", "counter", "Windows judged, by verdict")
        async for (loop, verdict), count in breathing(list(self._verdicts.items())):
            verdicts.lines.append(
                f'slipjump_diagnoses_total{{loop="{_escaped(loop)}",verdict="{verdict}"}} {count}.0'
            )
        yield generate_latest(self._registry)
        lines = (
            each.lines[k : k + LINES] for each in (*rows, verdicts) for k in range(0, len(each.lines), LINES)
        )
        async for some in breathing(lines):
            yield "\n".join((*some, "")).encode()

    def judged(self, judged: Judged) -> None:
        """Count a verdict."""
        self._verdicts[judged.diagnosis.loop, judged.diagnosis.verdict] += 1
        self._windows.observe(judged.took)
        if judged.fitted:
            self._fits.observe(judged.diagnosis.seconds)

    def announced(self, announcement: Announcement) -> None:
        """Count a change of an alarm."""
        self._changes.labels(announcement.alarm.state.value).inc()

    def describe(self) -> Iterable[Metric]:
        """Return nothing: the daemon need not run yet when this is registered."""
        return ()

    def collect(self) -> Iterable[Metric]:
        """Return what is not of single loops."""
        now = self._status
        if now is None:
            return
        yield InfoMetricFamily("slipjump_build", "This program", {"version": version("slipjump")})
        yield GaugeMetricFamily("slipjump_hung", "Tasks that hang", len(now.hung))
        yield GaugeMetricFamily("slipjump_worker_queue", "Calculations that wait for a worker", now.queued)
        for name, text, of_agent in AGENT_COUNTERS:
            yield CounterMetricFamily(f"slipjump_{name}", text, of_agent(now))
        alarms = GaugeMetricFamily("slipjump_alarms", "Alarms, by state", labels=["state"])
        for state in State:
            alarms.add_metric([state.value], self._alarms[state])
        yield alarms
        yield from _connections(now.connections)


class _LoopMetric:
    """One metric of all loops, line by line as they are looked at."""

    def __init__(self, name: str, kind: str, text: str, value_of: ValueOf = lambda _: None) -> None:
        self.lines = [f"# HELP {name} {text}", f"# TYPE {name} {kind}"]
        self._begin = f'{name}{{loop="'
        self._value_of = value_of

    def add(self, loop: str, status: LoopStatus) -> None:
        """Add the line of a loop, where it has a value."""
        value = self._value_of(status)
        if value is not None:
            self.lines.append(f'{self._begin}{loop}"}} {_go(value)}')


_go: Callable[[float], str] = floatToGoString


def _escaped(label: str) -> str:
    """Return a label as Prometheus has it between quotes."""
    return label.replace("\\", "\\\\").replace('"', '\\"')


def _connections(there: Sequence[ConnectionStatus]) -> Iterator[Metric]:
    """One metric for each row, with a value for each connection that has one."""
    for family_of, rows in (
        (GaugeMetricFamily, CONNECTION_GAUGES),
        (CounterMetricFamily, CONNECTION_COUNTERS),
    ):
        for name, text, value_of in rows:
            family = family_of(f"slipjump_connection_{name}", text, labels=["connection"])
            for each in there:
                value = value_of(each)
                if value is not None:
                    family.add_metric([each.connection], float(value))
            yield family
