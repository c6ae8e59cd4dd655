"""Topics made from templates, and what is wrong in them told when the file is read."""

import pytest
from pydantic import ValidationError

from connectors.base import ConfigError
from connectors.mqtt.options import MqttOptions, MqttTarget
from connectors.mqtt.topics import topics_of
from connectors.options import LoopTags

UNS = {
    "topic": "{enterprise}/{site}/{area}/{loop}/stiction",
    "variables": {"enterprise": "acme", "site": "x"},
}


def told(topic=None, **variables):
    return LoopTags({}, [MqttTarget(connection="broker", topic=topic)], variables)


def faults_of(loops, **options):
    with pytest.raises(ConfigError) as caught:
        topics_of("broker", MqttOptions.model_validate(options), loops)
    return caught.value.faults


def test_variables_of_the_loop_come_before_those_of_the_connection():
    loops = {"FIC101": told(area="a1"), "FIC102": told(area="a2", site="y"), "FIC103": told("plain/{loop}")}
    topics = topics_of("broker", MqttOptions.model_validate({**UNS, "orders": True, "client": "me"}), loops)
    assert topics.alarms == {
        "FIC101": ("acme/x/a1/FIC101/stiction",),
        "FIC102": ("acme/y/a2/FIC102/stiction",),
        "FIC103": ("plain/FIC103",),
    }
    assert topics.orders == {f"{topic}/order": loop for loop, (topic,) in topics.alarms.items()}
    assert topics.status == "slipjump/me/status"


def test_without_a_name_of_its_own_a_client_has_that_of_computer_and_connection(monkeypatch):
    monkeypatch.setattr("socket.gethostname", lambda: "gate7")
    assert topics_of("broker", MqttOptions(), {}).status == "slipjump/gate7-broker/status"


def test_orders_are_not_taken_unless_requested_nor_by_a_guest():
    assert topics_of("broker", MqttOptions(), {"FIC101": told()}).orders == {}
    guest = MqttOptions(orders=True, client="me").as_guest()
    topics = topics_of("broker", guest, {"FIC101": told()})
    assert (topics.orders, topics.status, guest.client) == ({}, None, None)


@pytest.mark.parametrize(
    ("options", "loops", "fault"),
    [
        (
            UNS,
            {"FIC101": told()},
            "loops.FIC101.publish.topic: no variable is called area (there are: client",
        ),
        ({"topic": "stiction"}, {"A": told(), "B": told()}, "connections.broker: 2 alarms would be"),
        (UNS, {"A": told(area="a/#")}, "has an empty level, or + or # in it"),
        (UNS, {"A": told(area="")}, "'acme/x//A/stiction' begins with $, or has an empty level"),
        ({"topic": "{c}/x", "variables": {"c": "$SYS"}}, {"A": told()}, "begins with $"),
        ({"status": "{where}/s"}, {}, "connections.broker.status: no variable is called where"),
        (
            {"orders": True, "order_topic": "{x}"},
            {"A": told()},
            "connections.broker.order_topic: no variable",
        ),
    ],
)
def test_a_topic_that_makes_no_sense_is_a_fault(options, loops, fault):
    (line,) = faults_of(loops, **options)
    assert fault in line


@pytest.mark.parametrize(
    "topic",
    ["", "a/+/b", "a/#", "a\0", "{loop", "loop}", "{}", "{0}", "{loop!r}", "{loop:>9}", "{loop.name}"],
)
def test_a_template_has_plain_variables_and_no_wildcard(topic):
    with pytest.raises(ValidationError):
        MqttOptions(topic=topic)
    with pytest.raises(ValidationError):
        MqttTarget(connection="broker", topic=topic)


@pytest.mark.parametrize("client", ["", "a/b", "a b", "#", "$me"])
def test_a_client_is_one_level(client):
    with pytest.raises(ValidationError):
        MqttOptions(client=client)
