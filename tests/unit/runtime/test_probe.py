"""What `slipjump check --connect` finds out on a bus in memory: each fault in words, nothing written."""

import asyncio
import time
from dataclasses import replace

import pytest

from agent.runtime.commission import probe as probing
from agent.runtime.commission.plausibility import Reading, problems, remarks
from agent.runtime.commission.probe import probe
from agent.settings import settings_of
from connectors.base import AccessDeniedError, ConnectionLostError, LoopRole, Quality, Sample, TargetReport
from tests.unit.runtime.fake_bus import FakeBus

NOW = 1_700_000_000.0


def settings(**more):
    tag = {"table": "input", "address": 0}
    loop = {"name": "F1", "connection": "bus", "ts": 1.0, "tags": {"pv": tag, "op": tag, "mode": tag}}
    ranges = {"op_range": [0, 100], "pv_range": [0, 50], "publish": [{"connection": "bus"}]}
    return settings_of({"connections": {"bus": {"kind": "modbus"}}, "loops": [{**loop, **ranges, **more}]})


def reading(value, *, role="pv", age=0.0, quality=Quality.GOOD, first=None, **more):
    sample = Sample.measured(LoopRole("F1", role), NOW - age, value, quality, **more)
    one = Reading(replace(sample, value=value if first is None else first), NOW, sample)
    return (
        one if first is None else Reading(sample, NOW, sample).followed_by(replace(sample, value=first), NOW)
    )


@pytest.mark.parametrize(
    ("role", "sample", "told"),
    [
        ("pv", {"value": 54.0}, None),
        ("pv", {"value": 56.0}, "outside pv_range 0 to 50"),
        ("sp", {"value": -20.0}, "outside pv_range 0 to 50"),
        ("op", {"value": 1e30}, "outside op_range 0 to 100"),
        ("mv", {"value": 1e30}, None),
        ("pv", {"value": "n/a"}, "the text 'n/a' where a number belongs"),
        ("pv", {"value": float("nan")}, "nan where a number belongs"),
        ("pv", {"value": 5.0, "quality": Quality.BAD, "code": 0x80310000}, "bad quality, code 0x80310000"),
        ("pv", {"value": 5.0, "age": -60.0}, "its clock is 60 s ahead"),
        ("pv", {"value": 5.0, "first": 6.0}, "its value changes but its source time does not"),
    ],
)
def test_what_must_be_put_right(role, sample, told):
    (loop,) = settings().loops
    found = problems(reading(role=role, **sample), role, loop)
    assert found == () if told is None else found[0].startswith(told), found


def test_any_clock_is_accepted_where_the_configuration_does():
    (loop,) = settings().loops
    ahead = reading(5.0, age=-60.0)
    assert problems(ahead, "pv", loop)
    assert problems(ahead, "pv", loop, any_clock=True) == ()


@pytest.mark.parametrize(
    ("role", "sample", "watched", "told"),
    [
        ("pv", {"value": 5.0}, 0.0, None),
        ("pv", {"value": 5.0}, 2.0, None),
        ("pv", {"value": 5.0}, 5.0, "constant: did not change in 5 s"),
        ("op", {"value": 5.0}, 5.0, None),
        ("op", {"value": 5.0, "age": 59.0}, 0.0, None),
        ("op", {"value": 5.0, "age": 7200.0}, 0.0, "its source time is 2 h old: nothing new since"),
        ("pv", {"value": 5.0, "quality": Quality.UNCERTAIN}, 0.0, "uncertain quality"),
        ("mode", {"value": "AUTO"}, 0.0, None),
        ("mode", {"value": "MAN"}, 0.0, "not automatic: such stretches are not used"),
        ("mode", {"value": "PROG7"}, 0.0, "not known as automatic or manual"),
    ],
)
def test_what_should_be_known(role, sample, watched, told):
    (loop,) = settings().loops
    found = remarks(reading(role=role, **sample), role, loop, watched)
    assert found == () if told is None else found[0].startswith(told), found


@pytest.mark.parametrize(("step", "count", "told"), [(1.0, 5, False), (5.0, 3, True), (5.0, 2, False)])
def test_pv_that_comes_more_seldom_than_ts_says_is_reported(step, count, told):
    (loop,) = settings().loops
    samples = [now("pv", float(k)) for k in range(count)]
    samples = [replace(each, time=NOW + step * k) for k, each in enumerate(samples)]
    seen = Reading(samples[0], NOW, samples[0])
    for each in samples[1:]:
        seen = seen.followed_by(each, each.time)
    found = remarks(seen, "pv", loop, step * count)
    assert found == (("a value comes every 5 s, but ts is 1 s: set ts to that",) if told else ())


class CheckedBus(FakeBus):
    async def check_targets(self):
        return [TargetReport("F1", "coil 5", "it has no such address"), TargetReport("F1", "coil 6")]


def of_bus(monkeypatch, bus):
    monkeypatch.setattr(probing, "connectors_of", lambda _, **__: [bus])


def now(role, value, **more):
    return Sample(LoopRole("F1", role), time.time(), value, **more)


async def test_every_tag_and_target_is_reported_and_nothing_is_written(monkeypatch):
    bus = CheckedBus(lambda _: [now("pv", 5.0), now("op", 50.0), now("mode", "MAN"), now("pv", 6.0)])
    of_bus(monkeypatch, bus)
    findings = await probe(settings(), within=30.0, watch=0.05)
    assert [(each.what, each.place, bool(each.problems), bool(each.remarks)) for each in findings] == [
        ("connection", "", False, False),
        ("tag", "pv", False, False),
        ("tag", "op", False, False),
        ("tag", "mode", False, True),
        ("target", "coil 5", True, False),
        ("target", "coil 6", False, False),
    ]
    assert findings[1].reading.sample.value == 6.0  # it listened on after the first round
    assert bus.published == []
    assert bus.open == 0


async def test_a_silent_tag_is_reported_after_the_deadline(monkeypatch):
    of_bus(monkeypatch, FakeBus(lambda _: [now("pv", 5.0), now("mode", "AUTO")]))
    findings = await probe(settings(), within=0.1, watch=60.0)
    (silent,) = [each for each in findings if each.problems]
    assert (silent.place, silent.reading) == ("op", None)
    assert "no value within 0.1 s" in silent.problems[0]
    assert findings[-1].remarks == ("cannot be checked without publishing",)


@pytest.mark.parametrize(
    ("step", "told"),
    [
        (ConnectionLostError("reset by peer"), "lost: reset by peer"),
        (AccessDeniedError("check login"), "refused: check login"),
    ],
)
async def test_a_connection_that_fails_is_reported_once_and_its_tags_briefly(monkeypatch, step, told):
    of_bus(monkeypatch, FakeBus(lambda _: [now("pv", 5.0), step]))
    connection, pv, op, *_ = await probe(settings(), within=30.0)
    assert connection.problems == (told,)
    assert pv.problems == ()
    assert op.problems == ("not read: no connection",)


async def test_a_peer_that_is_not_there_and_one_that_never_answers(monkeypatch):
    bus = FakeBus(lambda _: [])
    bus.refuses_connection = True
    of_bus(monkeypatch, bus)
    connection, *_ = await probe(settings(), within=30.0)
    assert connection.problems == ("unreachable: refused",)

    class Stalls(FakeBus):
        def session(self):
            return self

        async def __aenter__(self):
            await asyncio.Event().wait()

        async def __aexit__(self, *_):
            pass

    of_bus(monkeypatch, Stalls(lambda _: []))
    connection, *_ = await probe(settings(), within=0.05)
    assert connection.problems == ("unreachable: no answer within 0.05 s",)
