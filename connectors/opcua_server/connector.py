"""An OPC UA server of our own as a connector: publications fill it, and people's orders come out."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager

from asyncua import Server, ua

from connectors.base import WITHDRAWN, Order, Publication, Session, TargetReport
from connectors.cancellation import obey_cancellation
from connectors.malformed import Malformed
from connectors.opcua_server.alarm.commands import Commands
from connectors.opcua_server.alarm.condition import Condition
from connectors.opcua_server.alarm.events import Events
from connectors.opcua_server.listening import listening, look_after, prepared
from connectors.opcua_server.options import OpcUaServerOptions, OpcUaServerTarget
from connectors.opcua_server.space.agent_view import AgentView
from connectors.opcua_server.space.loop_nodes import add_alarm_type
from connectors.opcua_server.space.loop_view import LoopView
from connectors.opcua_server.space.names import NAMESPACE, Names
from connectors.opcua_server.space.nodes import add_object, add_reference
from connectors.options import LoopTags, NoTag

logging.getLogger("asyncua").setLevel(logging.CRITICAL)  # passwords at DEBUG, and every client's faults

_LOOK = 1.0
"""s between two looks at clients that do not read."""
_LONGEST_BUILD = 0.25
"""Time that a loop may take to be built, s."""

ServedLoops = Mapping[str, LoopTags[NoTag, OpcUaServerTarget]]


class OpcUaServerConnector:
    """A server that others connect to. Its sessions show what the one before showed."""

    takes_orders = True

    def __init__(self, name: str, options: OpcUaServerOptions, loops: ServedLoops) -> None:
        self.name = name
        self._options = options
        self._loops = loops
        self._newest: dict[str, Publication] = {}
        self._malformed = Malformed("OPC UA server")

    @property
    def malformed(self) -> int:
        """What clients sent that could not be read, since the start."""
        return self._malformed.count

    @property
    def opens_within(self) -> float:
        """Longest time to build the address space, s: some 65 nodes a loop, 25 ms on an idle core."""
        return _LONGEST_BUILD * len(self._loops)

    @asynccontextmanager
    async def session(self) -> AsyncIterator[Session]:
        """Listen; raises ConnectionLostError where the port is taken, AccessDeniedError."""
        server = await prepared(self.name, self._options, self._malformed)
        session = await served(server, self._options, self._loops, self._newest)
        async with listening(server, self._options):
            yield session


class OpcUaServerSession:
    """A server at work."""

    def __init__(
        self,
        server: Server,
        views: Mapping[str, LoopView],
        agent: AgentView,
        commands: Commands,
        newest: dict[str, Publication],
    ) -> None:
        """Make it; ``newest`` keeps the last state of each loop for the session that follows."""
        self._server = server
        self._views = views
        self._agent = agent
        self._commands = commands
        self._newest = newest

    async def samples(self) -> AsyncIterator[Order]:
        """Yield the orders of operators; raises ConnectionLostError when the server no longer listens."""
        while True:
            try:
                async with asyncio.timeout(_LOOK):
                    order = await self._commands.orders.get()
            except TimeoutError:
                look_after(self._server)
            else:
                yield order
            obey_cancellation()

    async def check_targets(self) -> list[TargetReport]:
        """Report where each loop is shown; nothing can speak against it, as the server is ours."""
        return [TargetReport(loop, f"object {loop} of this server") for loop in self._views]

    async def publish(self, publication: Publication) -> None:
        """Show it; a loop that the configuration does not name here is left out."""
        view = self._views.get(publication.subject)
        if view is None or publication.kind == WITHDRAWN:  # the next server will not have it
            return
        if publication.kind == "state":
            self._newest[publication.subject] = publication
        await view.show(publication)
        conditions = (each.condition for each in self._views.values())
        await self._agent.show(conditions, self._commands.taken)


async def served(
    server: Server, options: OpcUaServerOptions, loops: ServedLoops, newest: dict[str, Publication]
) -> OpcUaServerSession:
    """Fill the address space of a server with loops, as their ``newest`` publications show them."""
    names = Names(await server.register_namespace(NAMESPACE))
    above = ua.NodeId(ua.ObjectIds.ObjectsFolder)
    add_object(
        server,
        above,
        names.folder,
        names.browse("slipjump"),
        kind=ua.NodeId(ua.ObjectIds.FolderType),
        reference=ua.ObjectIds.Organizes,
        notifies=True,
    )
    server_object = ua.NodeId(ua.ObjectIds.Server)
    add_reference(server, server_object, ua.ObjectIds.HasNotifier, names.folder)
    await server.get_node(server_object).set_event_notifier([ua.EventNotifier.SubscribeToEvents])
    add_alarm_type(server, names)
    events = Events(server, names.folder)
    views = {
        loop: LoopView(server, names, events, Condition(loop), options.longest_shelving) for loop in loops
    }
    commands = Commands(server, names, views, options.longest_shelving)
    for loop, view in views.items():
        await asyncio.sleep(0)  # building takes some ms, in which the other connections wait
        await view.build(next((target.unit for target in loops[loop].targets if target.unit), None))
        if loop in newest:
            await view.show(newest[loop])
    agent = AgentView(server, names)
    await agent.show((view.condition for view in views.values()), 0, published=False)
    return OpcUaServerSession(server, views, agent, commands, newest)
