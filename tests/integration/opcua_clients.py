"""Clients of our own OPC UA server: one that lists alarms, and one that goes around what it is offered."""

import contextlib

from asyncua import Client, ua

from connectors.checks.session import until

PERIOD = 50
"""ms."""
CONDITION = ua.NodeId(ua.ObjectIds.ConditionType)
FIELDS = [
    "EventId",
    "EventType",
    "SourceName",
    "Time",
    "Message",
    "Severity",
    "ConditionName",
    "Retain",
    "Comment",
    "ClientUserId",
    "ActiveState/Id",
    "AckedState/Id",
    "OutOfServiceState/Id",
    "SuppressedOrShelved",
    "ShelvingState/CurrentState/Id",
    "ShelvingState/UnshelveTime",
]
MARKS = {ua.ObjectIds.RefreshStartEventType: "start", ua.ObjectIds.RefreshEndEventType: "end"}


def acknowledgeable():
    """The filter of alarm lists such as UaExpert's and node-opcua's: a type and all below it."""
    kind = ua.LiteralOperand(ua.Variant(ua.NodeId(ua.ObjectIds.AcknowledgeableConditionType)))
    of_type = ua.ContentFilterElement(FilterOperator=ua.FilterOperator.OfType, FilterOperands=[kind])
    fields = [
        ua.SimpleAttributeOperand(
            TypeDefinitionId=ua.NodeId(ua.ObjectIds.BaseEventType),
            BrowsePath=[ua.QualifiedName(name) for name in path.split("/")],
            AttributeId=ua.AttributeIds.Value,
        )
        for path in FIELDS
    ]
    condition_id = ua.SimpleAttributeOperand(TypeDefinitionId=CONDITION, AttributeId=ua.AttributeIds.NodeId)
    return ua.EventFilter([*fields, condition_id], ua.ContentFilter([of_type]))


class AlarmList:
    """What an operator's client does: subscribes to events, asks for those before, and calls methods."""

    def __init__(self, client, subscription, index):
        self.client = client
        self.subscription = subscription
        self.index = index
        self.events = []

    def event_notification(self, event):
        self.events.append(event)

    def of(self, loop):
        """The events of a loop's alarm."""
        return [event for event in self.events if event.SourceName == loop]

    @property
    def marks(self):
        """What the events are: start and end of a refresh, or a loop."""
        return [MARKS.get(event.EventType.Identifier, event.SourceName) for event in self.events]

    async def newest(self, loop, count):
        """Wait for so many events of a loop and return the newest."""
        await until(lambda: len(self.of(loop)) >= count, within=30.0)
        return self.of(loop)[-1]

    async def refresh(self, subscription=None):
        """ConditionRefresh, and wait for its end."""
        ends = self.marks.count("end")
        method = ua.NodeId(ua.ObjectIds.ConditionType_ConditionRefresh)
        number = self.subscription.subscription_id if subscription is None else subscription
        await self.client.get_node(CONDITION).call_method(method, ua.Variant(number, ua.VariantType.UInt32))
        await until(lambda: self.marks.count("end") > ends, within=30.0)

    async def call(self, loop, method, *arguments, part=""):
        """Call a method of a loop's alarm by the name that its type has; return the name of the answer."""
        node = self.node(f"{loop}.Alarm{part}")
        try:
            await node.call_method(ua.NodeId(getattr(ua.ObjectIds, method)), *arguments)
        except ua.UaStatusCodeError as error:
            return ua.StatusCode(error.code).name
        return "Good"

    async def acknowledge(self, event, comment=""):
        return await self.call(
            event.SourceName,
            "AcknowledgeableConditionType_Acknowledge",
            event.EventId,
            ua.LocalizedText(comment),
        )

    def node(self, text):
        return self.client.get_node(ua.NodeId(text, self.index))


@contextlib.asynccontextmanager
async def alarm_list(client, source=ua.ObjectIds.Server):
    """Subscribe a connected client; ``source``: node that tells events."""
    index = await client.get_namespace_index("urn:slipjump")
    alarms = AlarmList(client, None, index)
    alarms.subscription = await client.create_subscription(PERIOD, alarms)
    node = alarms.node(source) if isinstance(source, str) else source
    await alarms.subscription.subscribe_events(node, evfilter=acknowledgeable())
    yield alarms


@contextlib.asynccontextmanager
async def alarms_at(port, source=ua.ObjectIds.Server):
    """Connect without security and subscribe."""
    async with (
        Client(f"opc.tcp://127.0.0.1:{port}", timeout=30) as client,
        alarm_list(client, source) as made,
    ):
        yield made


async def session_around_the_endpoints(port, password):
    """Log jane in on an unprotected channel without asking which endpoints there are, and read a node."""
    url = f"opc.tcp://127.0.0.1:{port}"
    client = Client(url, timeout=30)
    try:
        await client.connect_socket()
        await client.send_hello()
        await client.open_secure_channel()
        wanted = ua.CreateSessionParameters(
            EndpointUrl=url, SessionName="x", ClientNonce=b"0" * 32, RequestedSessionTimeout=10_000
        )
        await client.uaclient.create_session(wanted)
        token = ua.UserNameIdentityToken(
            PolicyId="username", UserName="jane", Password=password.encode(), EncryptionAlgorithm=""
        )
        await client.uaclient.activate_session(ua.ActivateSessionParameters(UserIdentityToken=token))
        return await client.get_node(ua.NodeId(ua.ObjectIds.Server_ServerStatus_CurrentTime)).read_value()
    finally:
        client.disconnect_socket()
