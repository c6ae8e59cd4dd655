"""PV and OP from clocks that differ: noticed, stated, and no verdict."""

import math

import numpy as np
import pytest

from agent.analysis.diagnose import diagnose
from agent.runtime.intake.source_clock import SourceClock
from agent.runtime.intake.tag_clocks import TagClocks
from tests.unit.runtime.agents import agent_of, virtual, worked
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START, sample


def apart(arrivals, ts=1.0):
    """The difference after values of (role, time, arrival)."""
    clocks = TagClocks(ts)
    for each in arrivals:
        clocks.see(*each)
    return clocks.apart


def steady(off, n=60, op_every=1, speed=1.0):
    for k in range(n):
        yield "pv", speed * k, k + 0.05
        if k % op_every == 0:
            yield "op", speed * k - off, k + 0.3


@pytest.mark.parametrize("off", [20.0, -20.0, 7200.0, 3.0])
def test_clocks_that_differ_are_noticed(off):
    assert apart(steady(off)) == pytest.approx(off, abs=0.5)
    assert apart(steady(off, n=400, op_every=30)) == pytest.approx(off, abs=0.5)


@pytest.mark.parametrize(
    "arrivals",
    [
        steady(0.0),
        steady(1.0),
        steady(20.0, n=4),
        steady(0.0, n=900, op_every=60),
        steady(0.0, n=900, op_every=60, speed=60.0),  # a recording that is played fast
        [("pv", float(k), 10.0 * math.ceil(k / 10)) for k in range(1, 100)]  # sent in bundles
        + [("op", float(k), k + 0.1) for k in range(100)],
        [("op", -5000.0, 0.0), *steady(0.0)],  # what it had for long when it was first read
        [(role, float(k), 100.0 + 0.01 * k) for role in ("pv", "op") for k in range(100)],  # role after role
    ],
)
def test_what_is_only_late_is_no_clock(arrivals):
    assert apart(arrivals) == 0.0


def test_a_long_sampling_time_bears_more():
    assert apart(steady(15.0), ts=10.0) == 0.0
    assert apart(steady(25.0), ts=10.0) == pytest.approx(25.0, abs=0.5)


def test_clocks_that_were_set_right_are_believed_after_some_samples():
    late = [(role, time + 60.0, arrival + 60.0) for role, time, arrival in steady(0.0)]
    assert apart([*steady(20.0), *late]) == 0.0


def sticking(off):
    """A limit cycle whose OP bears the times of another clock."""
    noise = np.random.default_rng(1).normal(0, 0.05, (4000, 2))

    def source(session):
        for k in range(1500):
            t = session * 1500 + k
            yield sample("pv", t, 50 + 2 * math.copysign(1, math.sin(t / 8)) + noise[t, 0])
            yield sample("op", t - off, 50 + 5 * math.asin(math.sin(t / 8 - 1)) + noise[t, 1])
            yield 1.0

    return source


@pytest.mark.parametrize("off", [20.0, 7200.0, -7200.0])
def test_they_are_stated_and_give_no_verdict(off, caplog):
    seen = []
    agent = agent_of(FakeBus(sticking(off)), diagnose=diagnose, seen=seen)
    for pipeline in agent.pipelines.values():
        pipeline.intake.clock = SourceClock("FIC101", 86400.0, lambda: START)
    status = virtual(worked(agent, 1400.0))
    assert seen
    assert {each.verdict for each in seen} == {"not_testable"}
    assert [fault.name for fault in seen[-1].faults] == ["clocks_differ"]
    way = "ahead of" if off > 0 else "behind"
    assert f"{way} that of OP" in seen[-1].faults[0].reason
    assert caplog.text.count("the clock of PV is") == 1
    assert f"the clock of PV is {off:.0f} s ahead of that of OP" in status[0].problem


def test_one_clock_has_its_verdict():
    seen = []
    agent = agent_of(FakeBus(sticking(0.0)), seen=seen)
    status = virtual(worked(agent, 900.0))
    assert {each.verdict for each in seen} == {"stiction"}
    assert status[0].problem == ""


def test_each_role_has_its_own_clock_and_none_is_dropped():
    clock = SourceClock("FIC101", 86400.0, lambda: START)
    for k in range(30):
        pv, op = sample("pv", k, 1.0), sample("op", k + 7200.0, 1.0)
        taken = [clock.checked(pv, k), clock.checked(op, k + 0.1)]
        assert taken[0] == pv
        assert taken[1] == op or k <= 1
    assert clock.leaps <= 2


def test_a_role_that_changes_seldom_follows_the_clock_that_others_show_to_be_set():
    clock = SourceClock("FIC101", 86400.0, lambda: START)
    clock.checked(sample("op", 0.0, 1.0), 0.0)
    for k in range(100):
        clock.checked(sample("pv", k + (3600.0 if k > 50 else 0.0), 1.0), k)
    late = sample("op", 3700.0, 2.0)
    assert clock.checked(late, 100.0) == late
