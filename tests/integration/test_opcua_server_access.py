"""Who may do what at our OPC UA server, and how much a client may request."""

import asyncio
import contextlib
import struct

import pytest
import pytest_asyncio
from asyncua import Client, ua
from buses import until
from opcua_clients import alarm_list, alarms_at, session_around_the_endpoints
from secure_peers import PASSWORD, make_keys

from connectors.opcua_server.asyncua_private import client_sessions, monitored_items
from connectors.opcua_server.listening import look_after
from tests.integration.opcua_served import LOOPS, client_of, serving

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.timeout(180),  # a start loads thousands of nodes: ten times longer where others compute
]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def served():
    """A server on this machine where everybody may give orders; each test has a loop of its own."""
    async with serving(anonymous="order") as made:
        yield made


@pytest.fixture(scope="module")
def keys(tmp_path_factory):
    folder = make_keys(tmp_path_factory.mktemp("keys"))
    (folder / "password").write_text(PASSWORD)
    return folder


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def guarded(keys):
    """A server that knows one client and two users."""
    security = {"certificate": f"{keys}/opcua.pem", "key": f"{keys}/opcua-key.pem"}
    password = {"file": f"{keys}/password"}
    async with serving(
        security={**security, "clients": [f"{keys}/opcua.der"], "ca": f"{keys}/ca.pem", "sign_only": True},
        users={"jane": {"password": password}, "wall": {"password": password, "may": "read"}},
        anonymous="refused",
    ) as made:
        yield made


async def test_users_do_what_they_may(guarded, keys):
    await guarded.become("FIC101", "unacked_active")
    async with client_of(guarded, keys) as client, alarm_list(client) as alarms:
        await alarms.refresh()
        assert await alarms.acknowledge(alarms.of("FIC101")[0]) == "Good"
        assert (await guarded.order()).by == "jane"
        with pytest.raises(ua.UaStatusCodeError, match="BadUserAccessDenied"):
            await alarms.node("FIC101.S").write_value(9.0)
    async with client_of(guarded, keys, "wall", mode="Sign") as client, alarm_list(client) as alarms:
        await alarms.refresh()
        assert await alarms.acknowledge(alarms.of("FIC101")[0]) == "BadUserAccessDenied"


async def test_strangers_stay_outside(guarded, keys, caplog):
    for user, password in (("jane", "wrong"), ("jim", PASSWORD), ("jane", "")):
        with pytest.raises(ua.UaStatusCodeError, match="BadUserAccessDenied"):
            async with client_of(guarded, keys, user, password):
                pass
    with pytest.raises(ua.UaStatusCodeError, match="BadCertificateUntrusted"):
        async with client_of(guarded, keys, certificate="stranger"):
            pass
    with pytest.raises(ua.UaStatusCodeError, match="BadCertificateUntrusted"):
        await session_around_the_endpoints(guarded.port, PASSWORD)
    assert "user 'jim' was not let in" in caplog.text
    assert PASSWORD not in caplog.text


async def test_nobody_can_write_any_node(served):
    space = served.session._server.iserver.aspace
    levels = (ua.AttributeIds.AccessLevel, ua.AttributeIds.UserAccessLevel)
    bit = 1 << ua.AccessLevel.CurrentWrite

    def writable(node, level):
        value = space.read_attribute_value(node, level).Value
        return value is not None and bool((value.Value or 0) & bit)

    nodes = list(space.keys())
    assert not [node for node in nodes if all(writable(node, level) for level in levels)]
    assert len(nodes) > 5000


async def test_what_a_client_may_request_is_bounded(served, monkeypatch):
    internal = served.session._server.iserver
    async with alarms_at(served.port) as alarms:
        eager = await alarms.client.create_subscription(0.001)
        kept = internal.subscription_service.subscriptions[eager.subscription_id]
        assert kept.data.RevisedPublishingInterval == 50.0
        await eager.subscribe_data_change(alarms.node("FIC101.S"), queuesize=0)
        assert [item.queue_size for item in monitored_items(kept).values()] == [1000]
        monkeypatch.setattr("connectors.opcua_server.caller.MOST_ITEMS", 1)
        with pytest.raises(ua.UaStatusCodeError, match="BadTooManyMonitoredItems"):
            await eager.subscribe_data_change(alarms.node("FIC101.J"))
        with pytest.raises(ua.UaStatusCodeError, match="BadServiceUnsupported"):
            await alarms.client.uaclient.register_server(ua.RegisteredServer())
        assert {session.session_timeout for session in client_sessions(internal)} == {60.0}
        tokens = {session.auth_token.Identifier for session in client_sessions(internal)}
        assert all(isinstance(token, bytes) and len(token) == 32 for token in tokens)


async def test_a_client_that_sends_without_end_is_dropped(served):
    reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.write(b"HELF" + struct.pack("<I", 2**31) + bytes(2**20))
    with contextlib.suppress(ConnectionError):
        assert await reader.read() == b""
    writer.close()
    async with alarms_at(served.port) as alarms:  # the others are served
        assert await alarms.node("/Agent.Loops").read_value() == len(LOOPS)


async def test_a_client_that_does_not_read_is_dropped(served):
    server, schema = served.session._server, ua.NodeId(ua.ObjectIds.OpcUa_XmlSchema)
    assert len(server.iserver.aspace.read_attribute_value(schema, ua.AttributeIds.Value).Value.Value) > 2**17
    client = Client(f"opc.tcp://127.0.0.1:{served.port}", timeout=30)
    await client.connect()
    client.uaclient.protocol.transport.pause_reading()
    reads = [asyncio.create_task(client.get_node(schema).read_value()) for _ in range(200)]
    await until(
        lambda: any(c.transport.get_write_buffer_size() > 8 * 2**20 for c in server.bserver.clients), 30.0
    )
    look_after(server)
    client.uaclient.protocol.transport.resume_reading()
    results = await asyncio.gather(*reads, return_exceptions=True)
    assert any(isinstance(result, Exception) for result in results)
    with contextlib.suppress(ConnectionError, ua.UaError):
        await client.disconnect()
