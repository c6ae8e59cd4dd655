"""Only what the configuration names is written, whatever a publication holds."""

import math
from types import SimpleNamespace

from asyncua import ua

from connectors.base import WITHDRAWN, Publication
from connectors.modbus.codec import encode
from connectors.modbus.connector import ModbusSession
from connectors.modbus.options import ModbusOptions, ModbusTarget
from connectors.modbus.parking import Parking
from connectors.mqtt.connector import MqttConnector, MqttSession
from connectors.mqtt.options import MqttOptions, MqttTarget
from connectors.opcua.connector import OpcUaSession
from connectors.opcua.options import OpcUaOptions, OpcUaTarget
from connectors.options import LoopTags

FIELDS = {"active": True, "s": 4.0, "ns=2;s=FIC101.OP": 0.0, "topic": "plant/FIC101/OP", "address": 1}


async def publish(session):
    """What belongs to the loop, and what somebody might make it of."""
    for subject in ("FIC101", "FIC999", "../FIC101", "FIC101/OP"):
        for kind in ("state", "event"):
            await session.publish(Publication(subject, kind, "1", FIELDS))


async def test_modbus():
    written = []

    async def write(address, _):
        written.append(address)

    target = ModbusTarget(connection="plant", active={"address": 5}, fields={"s": {"address": 20}})
    client = SimpleNamespace(write_coil=write, write_registers=write)
    await publish(
        ModbusSession([client], ModbusOptions(), {"FIC101": LoopTags({}, [target])}, Parking("plant"))
    )
    assert written == [20, 5]


async def test_mqtt():
    written = []

    async def write(message):
        written.append(message.topic)

    loops = {"FIC101": LoopTags({}, [MqttTarget(connection="plant")])}
    connector = MqttConnector("plant", MqttOptions(), loops)
    client = SimpleNamespace(send=write)
    await publish(MqttSession(client, connector._readers, connector._topics, connector.orders))
    assert written == ["slipjump/FIC101/alarm", "slipjump/FIC101/alarm/event"]


async def test_of_a_loop_that_is_gone_no_alarm_stays_on_a_device_and_nothing_with_the_broker():
    written = []

    async def write(*what):
        written.append(what)

    gone = Publication("FIC101", WITHDRAWN, "1", {"active": False})
    target = ModbusTarget(connection="plant", active={"address": 5}, fields={"s": {"address": 20}})
    client = SimpleNamespace(write_coil=write, write_registers=write)
    loops = {"FIC101": LoopTags({}, [target])}
    await ModbusSession([client], ModbusOptions(), loops, Parking("plant")).publish(gone)
    assert written == [(20, encode(math.nan, "float32")), (5, False)]
    written.clear()
    loops = {"FIC101": LoopTags({}, [MqttTarget(connection="plant")])}
    connector = MqttConnector("plant", MqttOptions(), loops)
    client = SimpleNamespace(send=write)
    await MqttSession(client, connector._readers, connector._topics, connector.orders).publish(gone)
    ((message,),) = written
    assert (message.topic, message.payload, message.retain) == ("slipjump/FIC101/alarm", b"", True)


async def test_opcua():
    written = []

    async def write(nodes, _):
        written.extend(node.to_string() for node in nodes)
        return [ua.StatusCode()] * len(nodes)

    nodes = {"active": {"node": "ns=2;s=A"}, "fields": {"s": {"node": "ns=2;s=S"}}}
    client = SimpleNamespace(uaclient=SimpleNamespace(write_attributes=write))
    loops = {"FIC101": LoopTags({}, [OpcUaTarget(connection="plant", **nodes)])}
    session = OpcUaSession(client, OpcUaOptions(url="opc.tcp://plant"), loops, lambda _: None)
    session._types |= {"ns=2;s=A": ua.VariantType.Boolean, "ns=2;s=S": ua.VariantType.Double}
    await publish(session)
    assert written == ["ns=2;s=S", "ns=2;s=A"]
