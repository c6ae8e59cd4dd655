"""The player in virtual time: order, pace, and never ahead of the reader."""

import asyncio

import async_solipsism
import pytest

from simulators.clock import Clock
from simulators.plant import Row
from simulators.player import play


class Recording:
    def __init__(self, loop, start, ts, n):
        self.loop = loop
        self.ts = ts
        self._times = [start + ts * i for i in range(n)]

    def rows(self):
        return (Row(time, {"pv": 0.0, "op": 0.0}) for time in self._times)


class Bus:
    """Notes what is put when, and is read by a reader that takes every row ``delay`` s later, or never."""

    def __init__(self, lead=0, delay=0.0):
        self.lead = lead
        self.log = []
        self.most = 0
        self._delay = delay
        self._put = {}
        self._seen = {}

    async def put(self, loop, row):
        clock = asyncio.get_running_loop()
        self.log.append((clock.time(), loop, row.time))
        self._put.setdefault(loop, []).append(row.time)
        if self._delay is not None:
            clock.call_later(self._delay, self._seen.__setitem__, loop, row.time)

    def seen(self, loop):
        return self._seen.get(loop)

    def unseen(self, loop):
        newest = self._seen.get(loop, float("-inf"))
        return sum(time > newest for time in self._put.get(loop, []))


class WatchedBus(Bus):
    async def put(self, loop, row):
        self.most = max(self.most, self.unseen(loop))
        await super().put(loop, row)


def run(coroutine):
    with asyncio.Runner(loop_factory=async_solipsism.EventLoop) as runner:
        return runner.run(coroutine)


def test_loops_go_side_by_side_each_from_its_own_start():
    bus = Bus()
    run(play([Recording("A", 1e9, 1.0, 4), Recording("B", 5e8, 2.0, 2)], bus, Clock(10.0)))
    assert [(loop, time) for _, loop, time in bus.log] == [
        ("A", 1e9),
        ("B", 5e8),
        ("A", 1e9 + 1),
        ("A", 1e9 + 2),
        ("B", 5e8 + 2),
        ("A", 1e9 + 3),
    ]


def test_the_clock_sets_the_pace():
    bus = Bus()
    run(play([Recording("A", 0.0, 1.0, 11)], bus, Clock(10.0)))
    assert bus.log[-1][0] - bus.log[0][0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("lead", [0, 3])
def test_no_more_than_the_lead_waits_for_the_reader(lead):
    bus = WatchedBus(lead=lead, delay=0.5)
    run(play([Recording("A", 0.0, 1.0, 20)], bus, Clock(None), bus.seen))
    assert bus.most == lead
    assert [time for *_, time in bus.log] == [float(i) for i in range(20)]


def test_the_first_row_waits_for_a_reader_that_is_late():
    bus = Bus(lead=3, delay=20.0)
    run(play([Recording("A", 0.0, 1.0, 2)], bus, Clock(None), bus.seen))
    assert bus.log[1][0] >= 20.0


def test_the_end_waits_for_the_reader():
    bus = Bus(lead=100, delay=2.0)
    run(play([Recording("A", 0.0, 1.0, 5)], bus, Clock(None), bus.seen))
    assert bus.seen("A") == 4.0


def test_a_reader_that_never_reads_does_not_stop_the_player_and_is_logged(caplog):
    bus = Bus(lead=0, delay=None)
    run(play([Recording("A", 0.0, 1.0, 3)], bus, Clock(None), bus.seen))
    assert len(bus.log) == 3
    assert 30.0 <= bus.log[1][0] <= 31.0
    assert "A: the reader was too slow 3 times" in caplog.text
