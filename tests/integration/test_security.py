"""Encrypted peers that ask who one is: the right credentials work, each wrong one is told with its remedy."""

import asyncio
import logging
from dataclasses import replace

import pytest
import pytest_asyncio
from asyncua import ua
from buses import connector_of
from secure_peers import HOST, PASSWORD, make_keys, secure_broker, secure_device, secure_server

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import settings_of
from connectors.base import AccessDeniedError, ConnectionLostError, Publication
from connectors.checks import Reader
from connectors.checks.session import until
from tests.ports import free_port

in_the_loop_of_the_server = pytest.mark.asyncio(loop_scope="module")
ALARM = Publication("FIC101", "state", "1", {"active": True, "s": 4.0})


@pytest.fixture(scope="module")
def keys(tmp_path_factory):
    return make_keys(tmp_path_factory.mktemp("keys"))


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def guarded(keys):
    """An OPC UA server that trusts one client and knows two users; starting one takes longer than a test."""
    async with secure_server(keys) as url:
        yield url


@pytest.fixture
def password(tmp_path):
    path = tmp_path / "password"
    path.write_text(PASSWORD + "\n")
    return {"file": str(path)}


@pytest.fixture
def wrong(monkeypatch):
    monkeypatch.setenv("SLIPJUMP_TEST_PASSWORD", "open-sesame")
    return {"env": "SLIPJUMP_TEST_PASSWORD"}


def entry(tag, **publish):
    return {"name": "FIC101", "tags": {"pv": tag}, "publish": [{"connection": "plant", **publish}]}


def tls(keys, client=None, ca="ca"):
    identity = (
        {} if client is None else {"certificate": f"{keys}/{client}.pem", "key": f"{keys}/{client}-key.pem"}
    )
    return {"ca": f"{keys}/{ca}.pem", **identity}


def mqtt(port, **options):
    return connector_of(
        {"kind": "mqtt", "host": HOST, "port": port, "timeout": 2.0, **options}, [entry({"topic": "pv"})]
    )


def modbus(port, **options):
    pv, flag = {"table": "holding", "address": 0, "type": "uint16"}, {"address": 3}
    return connector_of(
        {"kind": "modbus", "host": HOST, "port": port, "poll": 0.01, **options}, [entry(pv, active=flag)]
    )


def opcua(url, **options):
    pv = {"node": "ns=1;s=PV"}
    return connector_of({"kind": "opcua", "url": url, **options}, [entry(pv, fields={"s": pv})])


def security(keys, client="opcua", **server):
    server = server or {"server_certificate": f"{keys}/server.pem"}
    return {"certificate": f"{keys}/{client}.pem", "key": f"{keys}/{client}-key.pem", **server}


async def denied(connector):
    """Open a session, ask for a sample, and return what is said instead."""
    with pytest.raises((ConnectionLostError, ExceptionGroup)) as caught:
        async with connector.session() as session, Reader(session) as reading:
            await reading.end(within=5.0)
    assert isinstance(caught.value, AccessDeniedError), caught.value
    return str(caught.value)


@pytest.mark.parametrize("version", ["3.1.1", "5"])
async def test_mqtt_with_tls_client_certificate_and_password(mosquitto, tmp_path, keys, password, version):
    async with secure_broker(mosquitto, tmp_path, keys, ask=True) as port:
        known = {"version": version, "tls": tls(keys, "client"), "user": "agent", "password": password}
        async with mqtt(port, **known).session() as session, Reader(session) as reading:
            async with mqtt(port, client="plant", **known).session() as plant:
                await plant._client.publish("pv", "1.5", qos=1, retain=True)
            await until(lambda: reading.samples)
            await session.publish(ALARM)
    assert reading.samples[0].value == 1.5


@pytest.mark.parametrize("version", ["3.1.1", "5"])
async def test_mqtt_with_a_wrong_credential(mosquitto, tmp_path, keys, password, wrong, version):
    async with secure_broker(mosquitto, tmp_path, keys, ask=True) as port:
        known = {"version": version, "tls": tls(keys, "client")}
        said = await denied(mqtt(port, **known, user="agent", password=wrong))
        assert "user agent in" in said
        assert "check user and password" in said
        assert "anonymous clients" in await denied(mqtt(port, **known))
        said = await denied(mqtt(port, version=version, tls=tls(keys), user="agent", password=password))
        assert "check tls.certificate and tls.key" in said
        said = await denied(
            mqtt(port, version=version, tls=tls(keys, "foreign"), user="agent", password=password)
        )
        assert "check tls.certificate and tls.key" in said
        said = await denied(mqtt(port, version=version, tls=tls(keys, "client", "foreign-ca")))
        assert "check tls.ca" in said


async def test_mqtt_with_a_certificate_for_another_host(mosquitto, tmp_path, keys, password):
    async with secure_broker(mosquitto, tmp_path, keys, "elsewhere") as port:
        said = await denied(mqtt(port, tls=tls(keys), user="agent", password=password))
    assert f"MQTT broker at {HOST}:{port}: its certificate is not accepted: IP address mismatch" in said


async def test_mqtt_with_tls_to_a_broker_without(keys):
    server = await asyncio.start_server(lambda _, writer: writer.write(b"HTTP/1.1 400 Bad Request"), HOST, 0)
    async with server:
        said = await denied(mqtt(server.sockets[0].getsockname()[1], tls=tls(keys)))
    assert "is this the port that speaks TLS?" in said


async def test_modbus_with_tls_and_client_certificate(keys):
    async with (
        secure_device(keys) as port,
        modbus(port, tls=tls(keys, "client")).session() as session,
        Reader(session) as reading,
    ):
        await until(lambda: reading.samples)
        await session.publish(ALARM)
    assert reading.samples[0].value == 7.0


@pytest.mark.parametrize(
    ("client", "ca", "server", "remedy"),
    [
        (None, "ca", "server", "check tls.certificate and tls.key"),
        ("foreign", "ca", "server", "check tls.certificate and tls.key"),
        ("client", "foreign-ca", "server", "check tls.ca"),
        ("client", "ca", "elsewhere", f"that the certificate is for {HOST}"),
    ],
)
async def test_modbus_with_a_wrong_credential(keys, client, ca, server, remedy):
    async with secure_device(keys, server) as port:
        assert remedy in await denied(modbus(port, tls=tls(keys, client, ca)))


@pytest.mark.parametrize("known_by", ["server_certificate", "ca"])
@pytest.mark.parametrize("login", ["password", "certificate"])
@in_the_loop_of_the_server
async def test_opcua_signed_and_encrypted_with_login(guarded, keys, password, known_by, login):
    server = {known_by: f"{keys}/{'server.der' if known_by == 'server_certificate' else 'ca.pem'}"}
    who = {
        "password": {"user": "agent", "password": password},
        "certificate": {"certificate": f"{keys}/client.der", "key": f"{keys}/client-key.pem"},
    }[login]
    connector = opcua(guarded, security=security(keys, **server), login=who)
    async with connector.session() as session, Reader(session) as reading:
        await until(lambda: reading.samples, within=30.0)
        before = reading.samples[0].value
        await session.publish(replace(ALARM, fields={"s": before + 1}))
        await until(lambda: len(reading.samples) == 2, within=30.0)
    assert [sample.value for sample in reading.samples] == [before, before + 1]


@in_the_loop_of_the_server
async def test_opcua_with_a_wrong_credential(guarded, keys, password, wrong):
    right = {"user": "agent", "password": password}
    said = await denied(opcua(guarded, security=security(keys), login={"user": "agent", "password": wrong}))
    assert "check login" in said
    assert "check login" in await denied(opcua(guarded, security=security(keys)))  # anonymous
    stranger = {"certificate": f"{keys}/stranger.pem", "key": f"{keys}/stranger-key.pem"}
    assert "check login" in await denied(opcua(guarded, security=security(keys), login=stranger))
    said = await denied(opcua(guarded, security=security(keys, "stranger"), login=right))
    assert "list of trusted clients (BadCertificateUntrusted)" in said
    other = {"server_certificate": f"{keys}/elsewhere.pem"}
    said = await denied(opcua(guarded, security=security(keys, **other), login=right))
    assert said.startswith(f"OPC UA server at {guarded}: it shows another certificate (SHA-256 ")
    assert "check security.ca" in await denied(
        opcua(guarded, security=security(keys, ca=f"{keys}/foreign-ca.pem"), login=right)
    )
    aes = {**security(keys), "policy": "Aes256Sha256RsaPss"}
    said = await denied(opcua(guarded, security=aes, login=right))
    assert "it offers no Aes256Sha256RsaPss SignAndEncrypt but Basic256Sha256 SignAndEncrypt" in said


async def test_opcua_with_a_certificate_for_another_host(keys, password):
    async with secure_server(keys, "elsewhere") as url:
        options = {
            "security": security(keys, ca=f"{keys}/ca.pem"),
            "login": {"user": "agent", "password": password},
        }
        assert f"is for elsewhere.example and not for {HOST}; check url" in await denied(
            opcua(url, **options)
        )


async def test_opcua_server_without_security(keys):
    async with secure_server(keys, policy=ua.SecurityPolicyType.NoSecurity) as url:
        assert "but None None_; check security.policy" in await denied(opcua(url, security=security(keys)))


@in_the_loop_of_the_server
async def test_the_daemon_goes_on_with_the_rest_and_reports_no_secret(
    guarded, mosquitto, tmp_path, keys, password, wrong, caplog
):
    loop = {"ts": 1.0, "window": {"seconds": 60.0}}
    topics = {"pv": {"topic": "pv"}, "op": {"topic": "op"}}
    nodes = {"pv": {"node": "ns=1;s=PV"}, "op": {"node": "ns=1;s=PV"}}
    async with secure_broker(mosquitto, tmp_path, keys) as port:
        broker = {"kind": "mqtt", "host": HOST, "port": port, "tls": tls(keys), "user": "agent"}
        dcs = {"kind": "opcua", "url": guarded, "security": security(keys)}
        settings = settings_of(
            {
                "agent": {"longest_wait": 0.2},
                "connections": {
                    "good": {**dcs, "login": {"user": "agent", "password": password}},
                    "bad": {**broker, "password": wrong},
                    "unset": {**broker, "password": {"env": "SLIPJUMP_NOT_SET"}},
                    "absent": {**broker, "port": free_port(), "password": password},
                    "fine": {**broker, "password": password},
                },
                "loops": [
                    {**loop, "name": name, "connection": name, "tags": nodes if name == "good" else topics}
                    for name in ("good", "bad", "unset", "absent", "fine")
                ],
            }
        )
        assert PASSWORD not in repr(settings)
        with caplog.at_level(logging.DEBUG):
            agent = Agent(settings, InlineExecutor())
            work = asyncio.create_task(agent.run())
            health = {c.health.name.removeprefix("connection "): c.health for c in agent.connections}
            await until(
                lambda: health["good"].up and all(health[n].losses > 5 for n in ("bad", "unset", "absent"))
            )
            async with mqtt(port, tls=tls(keys), user="agent", password=password).session() as plant:
                await plant._client.publish("pv", "1.5", qos=1, retain=True)
            await until(lambda: health["fine"].up)
            work.cancel()
            await asyncio.wait({work})
    ours = [r.message for r in caplog.records if r.name.startswith("agent") and "is down" in r.message]
    assert len(ours) == 3
    assert any(
        m.startswith(f"connection bad is down: MQTT broker at {HOST}:{port}: it does not let user")
        for m in ours
    )
    assert "connection unset is down: password: the environment variable SLIPJUMP_NOT_SET is not set" in ours
    assert caplog.records
    for secret in (PASSWORD, "open-sesame", "PRIVATE KEY"):
        assert secret not in caplog.text
