"""The edge node's messages and their numbers, and what a host may ask."""

import pytest

from agent.alarms import Alarm, Announcement
from connectors.base import Order, Publication
from connectors.sparkplug.metrics import _FIELDS, COMMANDS, METRICS, OUT_OF_SERVICE, REBIRTH, orders
from connectors.sparkplug.node import EdgeNode
from connectors.sparkplug.payload import DataType, MalformedMetricsError, Metric, decode

NOW = 1.8e9
FIELDS = {**Announcement("state", Alarm("FIC101"), 5.0).fields(), "sequence": 7, "historical": False}


def node(*loops, writable=True):
    return EdgeNode(
        "plant", "gate", {loop: f"{loop}-valve" for loop in loops or ("FIC101",)}, writable=writable
    )


def told(outgoing):
    payload = decode(outgoing.payload)
    return payload, {metric.name: metric for metric in payload.metrics}


def tell(gate, kind="state", **changes):
    return gate.data(Publication("FIC101", kind, "1", {**FIELDS, **changes}), NOW)


def test_births_have_every_metric_with_type_and_time_and_count_from_zero():
    gate = node("FIC101", "FIC102")
    gate.will(NOW)
    births = gate.births(NOW)
    assert [each.topic for each in births] == [
        "spBv1.0/plant/NBIRTH/gate",
        "spBv1.0/plant/DBIRTH/gate/FIC101-valve",
        "spBv1.0/plant/DBIRTH/gate/FIC102-valve",
    ]
    assert [(each.qos, each.retain) for each in births] == [(0, False)] * 3
    payloads = [decode(each.payload) for each in births]
    assert [payload.seq for payload in payloads] == [0, 1, 2]
    assert {payload.time for payload in payloads} == {NOW}
    names = [[metric.name for metric in payload.metrics] for payload in payloads]
    assert names == [["bdSeq", REBIRTH], [*METRICS, *COMMANDS], [*METRICS, *COMMANDS]]
    for payload in payloads:
        assert all(metric.type is not None and metric.time is not None for metric in payload.metrics)
    assert len({name.casefold() for name in names[1]}) == len(names[1])


def test_metrics_hold_every_field_of_the_payload_but_the_loop():
    fields = {field for field, _ in _FIELDS.values()}
    assert fields == FIELDS.keys() - {"loop", "historical"}  # the device, and a mark of each metric


def test_a_host_may_write_nothing_where_no_orders_are_taken():
    _, metrics = told(node(writable=False).births(NOW)[1])
    assert metrics.keys() == METRICS.keys()


def test_death_and_birth_of_a_connection_have_the_same_number_and_the_next_has_another():
    gate, numbers = node(), []
    for _ in range(258):
        will = gate.will(NOW)
        payload, metrics = told(will)
        assert (will.topic, will.qos, will.retain, payload.seq) == (
            "spBv1.0/plant/NDEATH/gate",
            1,
            False,
            None,
        )
        assert metrics.keys() == {"bdSeq"}
        numbers.append(metrics["bdSeq"].value)
        for birth in (gate.births(NOW)[0], gate.births(NOW)[0], gate.death(NOW)):
            assert told(birth)[1]["bdSeq"].value == numbers[-1]
    assert numbers == [*range(256), 0, 1]


def test_data_report_what_has_changed_and_a_birth_reports_all_again():
    gate = node()
    gate.births(NOW)
    payload, metrics = told(tell(gate))
    assert (payload.seq, metrics.keys()) == (2, METRICS.keys())
    payload, metrics = told(tell(gate, state="shelved", until=NOW, message_id="2", s=4.5))
    assert payload.seq == 3
    assert {name: metric.value for name, metric in metrics.items()} == {
        "Alarm/State": "shelved",
        "Alarm/Until": NOW,
        "Message/Id": "2",
        "Stiction/S": 4.5,
    }
    assert {metric.time for metric in metrics.values()} == {5.0}
    assert tell(gate, state="shelved", until=NOW, message_id="2", s=4.5) is None
    _, metrics = told(gate.births(NOW + 9)[1])
    assert (metrics["Alarm/State"].value, metrics["Alarm/State"].time) == ("shelved", 5.0)
    assert metrics["Stiction/J"].value is None


def test_the_sequence_wraps():
    gate = node()
    gate.births(NOW)
    seqs = [told(tell(gate, sequence=n))[0].seq for n in range(300)]
    assert seqs == [n % 256 for n in range(2, 302)]


def test_an_event_reported_late_is_history_and_changes_nothing_that_stands():
    gate = node()
    gate.births(NOW)
    tell(gate, state="acked_active")
    _, metrics = told(tell(gate, "event", state="unacked_active", historical=True, time=3.0))
    assert metrics.keys() == METRICS.keys()
    assert {metric.historical for metric in metrics.values()} == {True}
    assert {metric.time for metric in metrics.values()} == {3.0}
    assert told(gate.births(NOW)[1])[1]["Alarm/State"].value == "acked_active"


def test_what_is_out_of_service_says_so_in_the_metric_that_a_host_writes():
    gate = node()
    assert told(gate.births(NOW)[1])[1][OUT_OF_SERVICE].value is None
    assert told(tell(gate))[1][OUT_OF_SERVICE].value is False
    assert told(tell(gate, state="out_of_service"))[1][OUT_OF_SERVICE].value is True


def test_an_event_that_adds_nothing_to_its_state_is_not_reported_and_a_state_always_is():
    gate = node()
    gate.births(NOW)
    tell(gate, state="shelved", message_id="1", sequence=8)
    assert tell(gate, "event", state="shelved", message_id="2", sequence=9) is None
    _, metrics = told(tell(gate, "event", state="normal", message_id="3", sequence=10))
    assert metrics.keys() == {"Alarm/State", "Message/Id", "Message/Sequence"}
    _, metrics = told(tell(gate, state="normal", message_id="4", sequence=11, time=6.0))
    assert metrics.keys() == {"Message/Id", "Message/Sequence", "Message/Time"}


def test_of_others_nothing_is_reported():
    gate = node()
    gate.births(NOW)
    assert gate.data(Publication("FIC999", "state", "1", FIELDS), NOW) is None


def written(**values):
    names = {
        name.replace("Alarm/", "").replace(" ", "_").lower(): name
        for name in [*COMMANDS, OUT_OF_SERVICE, "Alarm/Id", "X"]
    }
    return tuple(Metric(names[key], value) for key, value in values.items())


@pytest.mark.parametrize(
    ("values", "order"),
    [
        ({"acknowledge": True}, Order("L", "acknowledge", "Sparkplug host")),
        (
            {"acknowledge": True, "operator": "jane", "id": "L/1"},
            Order("L", "acknowledge", "jane", None, "L/1"),
        ),
        ({"shelve_minutes": 30.0}, Order("L", "shelve", "Sparkplug host", NOW + 1800)),
        ({"unshelve": True}, Order("L", "unshelve", "Sparkplug host")),
        ({"out_of_service": True}, Order("L", "out_of_service", "Sparkplug host")),
        ({"out_of_service": False}, Order("L", "in_service", "Sparkplug host")),
    ],
)
def test_a_command_is_an_order(values, order):
    assert orders("L", written(**values), NOW) == [order]


def test_what_is_written_back_to_rest_requests_nothing():
    values = {"acknowledge": False, "unshelve": False, "shelve_minutes": 0.0, "operator": "jane"}
    assert orders("L", written(**values), NOW) == []


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"shelve_minutes": -1.0}, "greater than 0"),
        ({"shelve_minutes": "soon"}, "number"),
        ({"acknowledge": True, "operator": "a\nb"}, "match"),
        ({"x": 1}, "nobody can write X"),
    ],
)
def test_a_command_without_sense_is_malformed(values, why):
    with pytest.raises(MalformedMetricsError, match=why):
        orders("L", written(**values), NOW)


def test_types_are_those_of_the_specification():
    assert [kind.value for kind in (DataType.INT32, DataType.INT64, DataType.DOUBLE)] == [3, 4, 10]
    assert [kind.value for kind in (DataType.BOOLEAN, DataType.STRING, DataType.DATE_TIME)] == [11, 12, 13]
