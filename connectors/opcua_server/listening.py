"""A server that listens, stays within its bounds, and is gone without a trace when it ends."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager

from asyncua import Server, ua
from cryptography.hazmat.primitives.serialization import Encoding

from connectors.base import ConnectionLostError
from connectors.malformed import Malformed
from connectors.opcua.credentials import application_uri, certificate_in, private_key_in
from connectors.opcua_server.access import CertificateRights
from connectors.opcua_server.asyncua_private import client_sessions, is_listening
from connectors.opcua_server.caller import CallerServer
from connectors.opcua_server.options import OpcUaServerOptions
from connectors.opcua_server.strict import StrictServer
from connectors.reuse import listen_again

_LOG = logging.getLogger(__name__)
_MOST_BYTES = 8 * 2**20
"""What may wait for a client that does not read, bytes."""
_MOST_SUBSCRIPTIONS = 200
_LONGEST_QUEUE = 1000
"""Values or events that may wait for a monitored item."""
_MOST_UNREAD = 100
"""Messages of a subscription that are kept until the client says it has them."""
_FORGET = 60_000.0
"""How long a client that has vanished may come back to its session, ms; until then events wait for it."""
_MESSAGE = 2**20
"""Largest message that a client may send, bytes."""


async def prepared(name: str, options: OpcUaServerOptions, malformed: Malformed) -> Server:
    """Return a server with the standard address space; raises ConnectionLostError, AccessDeniedError."""
    with _as_connection_lost(options):
        _try_port(options)  # loading the standard address space takes a second, finding this out takes none
    internal = CallerServer(user_manager=CertificateRights(options))
    server = StrictServer(malformed, iserver=internal)
    server.name, server.product_uri, server.manufacturer_name = f"slipjump {name}", "urn:slipjump", "slipjump"
    server.application_type = ua.ApplicationType.Server
    _bound(server, options)
    await server.init()
    await server.set_application_uri(f"urn:{socket.gethostname()}:slipjump:{name}")
    server.set_endpoint(f"opc.tcp://{_in_url(options.host)}:{options.port}")
    await _protect(server, options)
    return server


@asynccontextmanager
async def listening(server: Server, options: OpcUaServerOptions) -> AsyncIterator[None]:
    """Let clients come in; raises ConnectionLostError."""
    with _as_connection_lost(options):
        await server.start()
    try:
        yield
    finally:
        await _stop(server)


def look_after(server: Server) -> None:
    """Drop clients for which too much waits; raises ConnectionLostError if nobody listens any more."""
    if not is_listening(server.bserver):
        raise ConnectionLostError("the OPC UA server no longer listens")
    for client in list(server.bserver.clients):
        if client.transport.get_write_buffer_size() > _MOST_BYTES:
            _LOG.warning("OPC UA server: client %s is dropped, it does not read", client.peer_name)
            client.transport.abort()


@contextmanager
def _as_connection_lost(options: OpcUaServerOptions) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        place = f"OPC UA server: cannot listen on {options.host}:{options.port}"
        raise ConnectionLostError(f"{place}: {error.strerror or error}") from error


def _try_port(options: OpcUaServerOptions) -> None:
    family, kind, _, _, address = socket.getaddrinfo(options.host, options.port, type=socket.SOCK_STREAM)[0]
    with socket.socket(family, kind) as probe:
        listen_again(probe)
        probe.bind(address)
        probe.listen()


def _in_url(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _bound(server: Server, options: OpcUaServerOptions) -> None:
    internal = server.iserver
    internal.max_connections = options.clients
    internal.max_session_timeout_ms = _FORGET
    internal.max_subscriptions = _MOST_SUBSCRIPTIONS
    internal.max_monitored_item_queue_size = _LONGEST_QUEUE
    internal.max_unacked_messages_per_subscription = _MOST_UNREAD
    server.limits.max_message_size = _MESSAGE
    server.limits.max_chunk_count = _MESSAGE // server.limits.max_recv_buffer + 1


async def _protect(server: Server, options: OpcUaServerOptions) -> None:
    security, tokens = options.security, []
    if options.anonymous != "refused":
        tokens.append(ua.AnonymousIdentityToken)
    if options.users:
        tokens.append(ua.UserNameIdentityToken)
    server.set_identity_tokens(tokens)
    if security is None:
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        return
    certificate = certificate_in("security.certificate", security.certificate)
    uri = application_uri("security.certificate", security.certificate, certificate)
    await server.set_application_uri(uri)
    await server.load_certificate(certificate.public_bytes(Encoding.DER), "der")
    key = private_key_in("security.key", security.key, security.key_password)
    await server.load_private_key(key, None, "der")
    policies = [ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt]
    if security.sign_only:
        policies.append(ua.SecurityPolicyType.Basic256Sha256_Sign)
    server.set_security_policy(policies)


async def _stop(server: Server) -> None:
    """Stop within milliseconds, whatever clients do; asyncua alone leaves sessions and waits for buffers."""
    internal = server.iserver
    clock, internal.time_task = internal.time_task, None
    if clock is not None:
        clock.cancel()
    for transport in list(internal.asyncio_transports):
        transport.abort()
    await asyncio.sleep(0)  # the transports notify their protocols, whose closing is then awaited by ``stop``
    await server.stop()
    for session in client_sessions(internal):
        await session.close_session()
