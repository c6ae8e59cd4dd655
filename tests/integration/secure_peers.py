"""Peers that encrypt and ask who one is, with certificates made by our own command."""

import asyncio
import contextlib
import ssl

from asyncua import Server, ua
from asyncua.common.utils import ServiceError
from asyncua.crypto.permission_rules import User
from asyncua.server.user_managers import UserManager, UserRole
from buses import mosquitto_broker
from cryptography.x509 import load_der_x509_certificate
from pymodbus.server import ModbusTlsServer
from pymodbus.simulator import DataType, SimData, SimDevice

from connectors.certificates import application, authority, signed
from tests.ports import free_port

HOST, ELSEWHERE = "127.0.0.1", "elsewhere.example"
PASSWORD = "correct-horse-battery-staple"  # noqa: S105
URI = "urn:agent:slipjump"


def make_keys(folder):
    """Write all certificates and keys the tests need; return the folder."""
    ca, foreign = authority("plant", 10), authority("somebody else", 10)
    made = {
        "ca": ca,
        "foreign-ca": foreign,
        "server": signed("broker", [HOST], 10, ca),
        "elsewhere": signed("broker", [ELSEWHERE], 10, ca),
        "client": signed("agent", ["agent"], 10, ca),
        "foreign": signed("agent", ["agent"], 10, foreign),
        "opcua": application("agent", ["agent"], URI, 10),
        "stranger": application("stranger", ["agent"], URI, 10),
    }
    for name, identity in made.items():
        (folder / f"{name}.pem").write_bytes(identity.pem())
        (folder / f"{name}.der").write_bytes(identity.der())
        (folder / f"{name}-key.pem").write_bytes(identity.key_pem())
    return folder


def server_context(keys, certificate="server"):
    """What a device needs that speaks TLS and asks for the client's certificate."""
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH, cafile=keys / "ca.pem")
    context.verify_mode = ssl.CERT_REQUIRED
    context.load_cert_chain(keys / f"{certificate}.pem", keys / f"{certificate}-key.pem")
    return context


@contextlib.asynccontextmanager
async def secure_broker(mosquitto, folder, keys, certificate="server", *, ask=False):
    """Run mosquitto with TLS and a user; with ``ask`` it wants a client certificate, too."""
    passwords = folder / "passwords"
    tool = await asyncio.create_subprocess_exec(
        "mosquitto_passwd", "-b", "-c", str(passwords), "agent", PASSWORD, stderr=asyncio.subprocess.DEVNULL
    )
    assert await tool.wait() == 0
    lines = [
        "user root",  # else it gives up its rights before it reads its key
        "allow_anonymous false",
        f"password_file {passwords}",
        f"cafile {keys / 'ca.pem'}",
        f"certfile {keys / certificate}.pem",
        f"keyfile {keys / certificate}-key.pem",
        f"require_certificate {str(ask).lower()}",
    ]
    async with mosquitto_broker(mosquitto, folder, lines) as (port, _):
        yield port


@contextlib.asynccontextmanager
async def secure_device(keys, certificate="server"):
    """Run a Modbus/TCP Security device with 16 coils and 16 holding registers."""
    bits = [SimData(0, values=[False] * 16, datatype=DataType.BITS)]
    registers = [SimData(0, values=[7] * 16, datatype=DataType.REGISTERS)]
    server = ModbusTlsServer(
        SimDevice(1, simdata=(bits, bits, registers, registers)),
        address=(HOST, 0),
        sslctx=server_context(keys, certificate),
    )
    await server.serve_forever(background=True)
    try:
        yield server.transport.sockets[0].getsockname()[1]
    finally:
        await server.shutdown()


class Users(UserManager):
    """One user with a password, and one with a certificate."""

    def __init__(self, certificate):
        self._certificate = certificate

    def get_user(self, iserver, username=None, password=None, certificate=None):  # noqa: ARG002
        if (username, password) == ("agent", PASSWORD) or (username is None and self._is_known(certificate)):
            return User(role=UserRole.Admin)
        return None

    def _is_known(self, certificate):
        return certificate is not None and load_der_x509_certificate(certificate) == self._certificate


@contextlib.asynccontextmanager
async def secure_server(
    keys, certificate="server", policy=ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt
):
    """Run an OPC UA server that trusts one client and knows two users; yields its URL."""
    trusted = load_der_x509_certificate((keys / "opcua.der").read_bytes())

    async def validate(shown, _):
        if shown != trusted:
            raise ServiceError(ua.StatusCodes.BadCertificateUntrusted)

    server = Server(user_manager=Users(load_der_x509_certificate((keys / "client.der").read_bytes())))
    await server.init()
    url = f"opc.tcp://{HOST}:{free_port()}"
    server.set_endpoint(url)
    server.set_security_policy([policy])
    server.set_certificate_validator(validate)
    await server.load_certificate(keys / f"{certificate}.pem")
    await server.load_private_key(keys / f"{certificate}-key.pem")
    node = await server.nodes.objects.add_variable(ua.NodeId.from_string("ns=1;s=PV"), "1:PV", 1.5)
    await node.set_writable()
    await server.start()
    try:
        yield url
    finally:
        await server.stop()
