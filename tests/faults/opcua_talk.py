"""An OPC UA client that may send anything: it knows just enough to get as far as a session."""

import asyncio
import contextlib
import struct

from asyncua import ua
from asyncua.common.connection import SecureConnection, TransportLimits
from asyncua.common.utils import Buffer
from asyncua.crypto.security_policies import SecurityPolicyNone
from asyncua.ua.ua_binary import header_from_binary, struct_from_binary, struct_to_binary, uatcp_to_binary

HELLO, OPEN, CHANNEL, SESSION = range(4)
"""How far it is: what it sends next."""


class Talk:
    """One connection."""

    def __init__(self, reader, writer):
        self.at = HELLO
        self._reader, self._writer = reader, writer
        self._channel = SecureConnection(SecurityPolicyNone(), TransportLimits())
        self._token = ua.NodeId()
        self._number = 0

    @classmethod
    async def to(cls, port):
        return cls(*await asyncio.open_connection("127.0.0.1", port))

    def message(self):
        """The bytes of what is to be sent next, in good order."""
        if self.at == HELLO:
            hello = ua.Hello(0, 65535, 65535, 0, 0, "opc.tcp://127.0.0.1")
            return uatcp_to_binary(ua.MessageType.Hello, hello)
        if self.at == OPEN:
            request = ua.OpenSecureChannelRequest()
            request.Parameters.SecurityMode = ua.MessageSecurityMode.None_
            request.Parameters.RequestedLifetime = 3_600_000
            return self._framed(request, ua.MessageType.SecureOpen)
        if self.at == CHANNEL:
            creation = ua.CreateSessionRequest()
            creation.Parameters.RequestedSessionTimeout = 3_600_000
            return self._framed(creation)
        return self._framed(self._any_request())

    async def go_on(self):
        """Send what is due and take the answer."""
        message, token = self.message(), self._token
        answer = await self.say(message)
        header = header_from_binary(answer)
        if self.at == OPEN:
            body = self._channel.receive_from_header_and_body(header, answer).body()
            opened = struct_from_binary(ua.OpenSecureChannelResponse, body).Parameters
            self._channel.set_channel(opened, ua.SecurityTokenRequestType.Issue, b"")
        elif self.at == CHANNEL and token == ua.NodeId():
            body = self._channel.receive_from_header_and_body(header, answer).body()
            self._token = struct_from_binary(ua.CreateSessionResponse, body).Parameters.AuthenticationToken
            activation = ua.ActivateSessionRequest()
            activation.Parameters.UserIdentityToken = ua.AnonymousIdentityToken("anonymous")
            answer = await self.say(self._framed(activation))
            self._channel.receive_from_header_and_body(header_from_binary(answer), answer)
        self.at += 1

    async def say(self, message):
        """Send and return one answer; None where the server hangs up instead."""
        self._writer.write(message)
        with contextlib.suppress(ConnectionError, asyncio.IncompleteReadError):
            async with asyncio.timeout(30):
                start = await self._reader.readexactly(8)
                return Buffer(start + await self._reader.readexactly(struct.unpack("<I", start[4:])[0] - 8))
        return None

    async def stop(self, message=b""):
        """Send what does not end, and return when the server has let go."""
        with contextlib.suppress(ConnectionError):
            async with asyncio.timeout(30):
                self._writer.write(message)
                self._writer.write_eof()
                await self._reader.read()
        self._writer.close()

    def _framed(self, request, kind=ua.MessageType.SecureMessage):
        self._number += 1
        request.RequestHeader.RequestHandle = self._number
        request.RequestHeader.AuthenticationToken = self._token
        return self._channel.message_to_binary(
            struct_to_binary(request), message_type=kind, request_id=self._number
        )

    def _any_request(self):
        node = ua.NodeId(ua.ObjectIds.Server)
        call = ua.CallRequest()
        call.Parameters.MethodsToCall = [
            ua.CallMethodRequest(node, ua.NodeId(ua.ObjectIds.Server_GetMonitoredItems), [ua.Variant(1)])
        ]
        read = ua.ReadRequest()
        read.Parameters.NodesToRead = [ua.ReadValueId(node, ua.AttributeIds.BrowseName)]
        browse = ua.BrowseRequest()
        browse.Parameters.NodesToBrowse = [ua.BrowseDescription(node)]
        watch = ua.CreateMonitoredItemsRequest()
        watch.Parameters.ItemsToCreate = [ua.MonitoredItemCreateRequest(read.Parameters.NodesToRead[0])]
        requests = (call, read, browse, watch, ua.CreateSubscriptionRequest(), ua.WriteRequest())
        return requests[self._number % len(requests)]
