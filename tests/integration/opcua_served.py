"""An OPC UA server of ours with loops whose alarms a test moves, and clients of it."""

import asyncio
import contextlib
import time

from asyncua import Client, ua
from asyncua.crypto.security_policies import SecurityPolicyBasic256Sha256
from buses import listens
from secure_peers import PASSWORD

from connectors.opcua_server.connector import OpcUaServerConnector
from connectors.opcua_server.options import OpcUaServerOptions, OpcUaServerTarget
from connectors.options import LoopTags
from tests.ports import free_port
from tests.unit.connectors.alarm_messages import told

LOOPS = tuple(f"FIC10{n}" for n in range(1, 7))


def connector_at(port, loops=LOOPS, **options):
    target = OpcUaServerTarget(connection="ours", unit="%")
    chosen = OpcUaServerOptions.model_validate({"port": port, **options})
    return OpcUaServerConnector("ours", chosen, dict.fromkeys(loops, LoopTags({}, [target])))


class Served:
    """A server at work and where it listens."""

    def __init__(self, session, port):
        self.publish = session.publish
        self.session = session
        self.port = port
        self._orders = session.samples()

    async def order(self):
        async with asyncio.timeout(30):
            return await anext(self._orders)

    async def become(self, loop, state, **fields):
        """Tell a change as the agent does: the state, then the event."""
        at = time.time()
        await self.publish(told(loop, state, at=at, **fields))
        await self.publish(told(loop, state, "event", at=at, **fields))


@contextlib.asynccontextmanager
async def serving(**options):
    port, before = free_port(), asyncio.all_tasks()
    async with connector_at(port, **options).session() as session:
        served = Served(session, port)
        yield served
        await served._orders.aclose()
    assert not listens(port)
    await asyncio.sleep(0)
    assert asyncio.all_tasks() - before - {asyncio.current_task()} == set(), "the server left tasks running"


@contextlib.asynccontextmanager
async def client_of(
    guarded, keys, user="jane", password=PASSWORD, certificate="opcua", *, mode="SignAndEncrypt"
):
    client = Client(f"opc.tcp://127.0.0.1:{guarded.port}", timeout=30)
    client.application_uri = "urn:agent:slipjump"
    client.set_user(user)
    client.set_password(password)
    await client.set_security(
        SecurityPolicyBasic256Sha256,
        f"{keys}/{certificate}.pem",
        f"{keys}/{certificate}-key.pem",
        mode=ua.MessageSecurityMode[mode],
    )
    async with client:
        yield client
