"""Our own Modbus server and its clients: what they read, what they may order, what they cannot do to it."""

import asyncio
import contextlib
import ssl
import struct

import pytest
from buses import listens, until
from pymodbus.client import AsyncModbusTcpClient, AsyncModbusTlsClient
from secure_peers import HOST, make_keys

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AgentSettings, ConnectionSettings, Settings
from connectors.base import AccessDeniedError, ConnectionLostError, Order, Publication
from connectors.modbus.codec import decode
from connectors.modbus_server import listening
from connectors.modbus_server import register_map as at
from connectors.modbus_server.connector import ModbusServerConnector
from connectors.modbus_server.options import ModbusServerOptions, ModbusServerTarget
from connectors.options import LoopTags, Options
from tests.ports import free_port
from tests.unit.runtime.agents import judged
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import loop_settings, sample

LOOPS = ("FIC1", "LIC2")
STATE = Publication("LIC2", "state", "1", {"state": "unacked_active", "active": True, "s": 4.5, "health": 4})


def connector_of(loops=LOOPS, **options):
    target = ModbusServerTarget(connection="scada")
    chosen = ModbusServerOptions.model_validate({"orders": True, **options}).model_copy(
        update={"port": options.get("port", 0)}
    )
    return ModbusServerConnector("scada", chosen, dict.fromkeys(loops, LoopTags({}, [target])))


@contextlib.asynccontextmanager
async def client_of(session, **more):
    client = AsyncModbusTcpClient("127.0.0.1", port=session.port, timeout=30, retries=0, **more)
    assert await client.connect()
    try:
        yield client
    finally:
        client.close()


async def connect(session):
    return await asyncio.open_connection("127.0.0.1", session.port)


def frame(number, pdu, unit=1):
    return struct.pack(">HHHB", number, 0, len(pdu) + 1, unit) + pdu


async def first_byte(port, tls):
    """The first byte of an answer; none where the server does not let the client in."""
    with contextlib.suppress(OSError):  # TLS 1.3 ends it in several ways
        reader, writer = await asyncio.open_connection(HOST, port, ssl=tls)
        try:
            writer.write(frame(1, b"\x03\x00\x00\x00\x01"))
            return await within(reader.read(1))
        finally:
            writer.transport.abort()
    return b""


async def within(what, seconds=30):
    async with asyncio.timeout(seconds):
        return await what


async def test_a_client_reads_what_is_reported_and_sees_the_heart_beat():
    async with connector_of().session() as session, client_of(session) as client:
        await session.publish(STATE)
        beating = asyncio.create_task(anext(session.samples()))
        beats = set()
        async with asyncio.timeout(30):
            while len(beats) < 3:
                header = (await client.read_holding_registers(0, count=8)).registers
                beats.add(header[at.HEARTBEAT])
                await asyncio.sleep(0.05)
        assert (header[0], header[2], header[3], header[4], header[5]) == (1, 2, 20, 20, 1)
        block = (await client.read_input_registers(at.block(1), count=at.BLOCK)).registers
        assert decode(block[6:8], "float32") == 4.5
        bits = (await client.read_discrete_inputs(at.BITS, count=16)).bits
        assert [bit for bit, is_set in enumerate(bits) if is_set] == [0, 11, 15]
        beyond = await client.read_holding_registers(at.block(2), count=1)
        assert beyond.exception_code == 2
        beating.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await beating


async def test_a_write_is_an_order_and_reads_0_again_when_it_was_obeyed():
    async with connector_of().session() as session, client_of(session) as client:
        orders = session.samples()
        await client.write_coil(1, True)
        assert await within(anext(orders)) == Order("LIC2", "acknowledge", "modbus 127.0.0.1")
        assert (await client.read_coils(0, count=2)).bits[:2] == [False, True]  # it is being obeyed
        await client.write_registers(at.block(0) + at.ORDER, [2, 60])
        shelving = await within(anext(orders))
        assert (shelving.subject, shelving.action) == ("FIC1", "shelve")
        assert (await client.read_coils(0, count=2)).bits[:2] == [False, False]
        assert (await client.write_register(at.block(0), 1)).exception_code == 2
        assert (await client.write_register(at.block(0) + at.ORDER, 77)).exception_code == 3


async def test_an_order_outlives_the_session_that_took_it():
    connector = connector_of()
    async with connector.session() as session, client_of(session) as client:
        await session.publish(STATE)
        await client.write_coil(0, True)
    async with connector.session() as session, client_of(session) as client:
        assert (await within(anext(session.samples()))).subject == "FIC1"
        assert (await client.read_holding_registers(at.block(1), count=1)).registers == [0x8801]


async def test_requests_in_one_segment_and_in_single_bytes_are_all_answered():
    async with connector_of().session() as session:
        reader, writer = await connect(session)
        asked = [frame(n, b"\x03" + struct.pack(">HH", n, 1)) for n in range(5)]
        writer.write(b"".join(asked))
        answers = await within(reader.readexactly(5 * 11))
        assert [answers[11 * n : 11 * n + 2] for n in range(5)] == [struct.pack(">H", n) for n in range(5)]
        for byte in asked[0]:
            writer.write(bytes([byte]))
            await writer.drain()
        assert (await within(reader.readexactly(11)))[-2:] == b"\x00\x01"
        writer.close()


@pytest.mark.parametrize(
    "garbage",
    [
        b"GET / HTTP/1.1\r\n\r\n",
        b"\xff" * 300,
        b"\x00\x01\x00\x00\x00\x01\x01",
        b"\x16\x03\x01\x02\x00\x01\x00",
    ],
)
async def test_who_speaks_something_else_is_dropped_and_the_others_are_served(garbage, caplog):
    async with connector_of().session() as session, client_of(session) as client:
        for _ in range(3):
            reader, writer = await connect(session)
            writer.write(garbage)
            with contextlib.suppress(ConnectionResetError):
                assert await within(reader.read()) == b""
            writer.close()
        assert (await client.read_holding_registers(0, count=1)).registers == [1]
    assert len([record for record in caplog.records if "does not speak Modbus" in record.message]) == 1


async def test_where_all_places_are_taken_the_longest_silent_client_gives_way(monkeypatch):
    monkeypatch.setattr(listening, "_GIVES_WAY", 1e9)
    async with connector_of(clients=2).session() as session:
        silent = [await connect(session) for _ in range(2)]
        extra, its_writer = await connect(session)
        assert await within(extra.read()) == b""
        monkeypatch.setattr(listening, "_GIVES_WAY", 0.0)
        async with client_of(session) as busy:
            assert not (await busy.read_coils(0, count=1)).isError()
            with contextlib.suppress(ConnectionResetError):
                assert await within(silent[0][0].read()) == b""
        for writer in (its_writer, *(each for _, each in silent)):
            writer.close()


async def test_bounds_of_clients_and_of_their_silence():
    async with connector_of(clients=2, idle=0.5).session() as session:
        first = await connect(session)
        second = await connect(session)
        for reader, writer in (first, second):  # both are served now
            writer.write(frame(1, b"\x03\x00\x00\x00\x01"))
            await within(reader.readexactly(11))
        reader, writer = await connect(session)
        with contextlib.suppress(ConnectionResetError):
            assert await within(reader.read()) == b""
        writer.close()
        for reader, writer in (first, second):  # and both go when they say nothing
            with contextlib.suppress(ConnectionResetError):
                assert await within(reader.read()) == b""
            writer.close()
        async with client_of(session) as client:
            assert not (await client.read_holding_registers(0, count=1)).isError()


async def test_who_is_not_allowed_and_which_unit_is_meant():
    async with connector_of(allow=["192.0.2.0/24"]).session() as session:
        reader, writer = await connect(session)
        with contextlib.suppress(ConnectionResetError):
            assert await within(reader.read()) == b""
        writer.close()
    async with connector_of(allow=["127.0.0.0/8"], unit=7).session() as session, client_of(session) as client:
        assert (await client.read_holding_registers(0, count=1, device_id=7)).registers == [1]
        assert (await client.read_holding_registers(0, count=1, device_id=1)).exception_code == 0x0B


async def test_a_port_that_is_taken_and_one_that_is_free_again(caplog):
    port = free_port()
    async with connector_of(port=port).session():
        with pytest.raises(ConnectionLostError, match=f"cannot listen on 127.0.0.1:{port}"):
            async with connector_of(port=port).session():
                pass
    async with connector_of(port=port).session() as session, client_of(session) as client:
        reader, writer = await connect(session)
        assert client.connected
    with contextlib.suppress(ConnectionResetError):
        assert await within(reader.read()) == b""  # nobody is left behind
    writer.close()
    assert not listens(port)
    assert [record.message for record in caplog.records if record.name == "asyncio"] == []


@pytest.mark.parametrize(
    "options",
    [{"host": "0.0.0.0"}, {"host": "::"}, {"host": "plant.example"}],  # noqa: S104 - is refused
)
def test_other_machines_are_let_in_on_purpose_only(options):
    with pytest.raises(ValueError, match="expected tls, allow, or unprotected: true"):
        ModbusServerOptions.model_validate(options)
    for on_purpose in ({"unprotected": True}, {"allow": ["192.0.2.1"]}):
        ModbusServerOptions.model_validate({**options, **on_purpose})


async def test_with_tls_only_known_clients_get_in_and_have_a_name(tmp_path):
    keys = make_keys(tmp_path)
    tls = {
        name: str(keys / file)
        for name, file in {"certificate": "server.pem", "key": "server-key.pem", "ca": "ca.pem"}.items()
    }

    def context(client):
        made = ssl.create_default_context(cafile=keys / "ca.pem")
        made.load_cert_chain(keys / f"{client}.pem", keys / f"{client}-key.pem")
        return made

    async with connector_of(tls=tls).session() as session:
        assert await first_byte(session.port, context("client")) == b"\x00"
        client = AsyncModbusTlsClient(
            HOST, port=session.port, sslctx=context("client"), timeout=30, retries=0
        )
        assert await client.connect()
        await client.write_coil(0, True)
        assert (await within(anext(session.samples()))).by == "modbus 127.0.0.1 agent"
        client.close()
        stranger = ssl.create_default_context(cafile=keys / "ca.pem")
        for wrong in (context("foreign"), stranger):
            assert await first_byte(session.port, wrong) == b""
        reader, writer = await connect(session)  # in the open
        writer.write(frame(1, b"\x03\x00\x00\x00\x01"))
        with contextlib.suppress(ConnectionResetError):
            assert b"\x03\x02" not in await within(reader.read())
        writer.close()
    for option, file in (("ca", "server-key.pem"), ("key", "client-key.pem"), ("certificate", "nowhere.pem")):
        with pytest.raises(AccessDeniedError, match=option if option != "key" else "belong together"):
            async with connector_of(tls={**tls, option: str(keys / file)}).session():
                pass


async def test_from_the_plant_to_the_panel_and_back():
    """The agent's alarm shows in the registers and is acknowledged by a coil."""
    port = free_port()
    target = ModbusServerTarget(connection="scada")
    loop = loop_settings("FIC1", connection="plant", seconds=100.0, quantify="always", publish=(target,))
    connections = {name: ConnectionSettings("fake", Options()) for name in ("plant", "scada")}

    def swing(_):
        for k in range(200):
            yield sample("pv", float(k), 50.0 + k % 7, loop="FIC1")
            yield sample("op", float(k), 50.0 - k % 5, loop="FIC1")

    agent = Agent(
        Settings(AgentSettings(clock_error=None), connections, (loop,)),
        InlineExecutor(),
        connectors=[FakeBus(swing, "plant"), connector_of(["FIC1"], port=port)],
        diagnose=judged(),
    )
    running = asyncio.create_task(agent.run())
    await until(lambda: listens(port), within=60)
    client = AsyncModbusTcpClient("127.0.0.1", port=port, timeout=30, retries=0)
    assert await client.connect()

    async def becomes(state, *, waits=False):
        async with asyncio.timeout(30):
            while True:
                block = (await client.read_holding_registers(at.block(0), count=at.BLOCK)).registers
                asked = (await client.read_coils(0, count=1)).bits[0]
                if (at.STATES[block[at.STATE]], asked) == (state, waits):
                    return
                await asyncio.sleep(0.01)

    await becomes("unacked_active")
    await client.write_coil(0, True)
    await becomes("acked_active")
    client.close()
    running.cancel()
    await asyncio.wait({running})
