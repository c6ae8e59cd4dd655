"""A node that stays the same is left alone; one that its server forgot is watched anew, but not for ever."""

import math

from asyncua import ua

from connectors.opcua.silence import MOST, Silence


def value(number):
    return ua.DataValue(ua.Variant(number, ua.VariantType.Double))


GONE = ua.DataValue(StatusCode=ua.StatusCode(ua.StatusCodes.BadNodeIdUnknown))


def test_only_what_was_not_reported_between_two_looks_is_silent():
    silence = Silence()
    for node in ("a", "b"):
        silence.watch(node)
    assert silence.silent() == []
    silence.told(["a"], [1.0])
    assert silence.silent() == ["b"]
    assert silence.silent() == ["a", "b"]


def test_a_value_that_was_reported_is_no_loss_however_often_it_is_read():
    silence = Silence()
    silence.watch("a")
    for number in (1.0, math.nan):
        silence.told(["a"], [number])
        silence.silent()
        assert not any(silence.is_lost("a", value(number)) for _ in range(10))


def test_another_value_twice_is_a_loss_and_a_report_between_is_not():
    silence = Silence()
    silence.watch("a")
    silence.told(["a"], [1.0])
    silence.silent()
    assert not silence.is_lost("a", value(2.0))
    silence.told(["a"], [2.0])
    silence.silent()
    assert not silence.is_lost("a", value(3.0))
    assert silence.is_lost("a", value(4.0))
    assert silence.silent() == []


def test_a_server_that_never_reads_what_it_reports_is_given_up_and_a_node_that_is_gone_never():
    silence = Silence()
    losses = 0
    for _ in range(50):
        silence.watch("a")
        silence.told(["a"], [1.0])
        silence.silent()
        losses += any(silence.is_lost("a", value(2.0)) for _ in range(2))
    assert losses == MOST
    for _ in range(50):
        silence.watch("a")
        assert silence.is_lost("a", GONE)
