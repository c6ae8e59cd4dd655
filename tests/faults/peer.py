"""A plant on one bus, in a process of its own so that it can be killed: a new row of each loop every 0.1 s.

    python -m tests.faults.peer BUS PORT

PORT is where modbus and opcua listen (0: any), and where the broker of mqtt is. It prints its port, then
obeys lines on stdin: ``clock SECONDS`` adds to the stamps of its rows, ``remove`` and ``restore`` take the
values of FIC101 away and bring them back, however the bus says that. Each is answered by ``done``.
"""

import asyncio
import contextlib
import sys
import time

from aiomqtt import MqttError
from asyncua import ua
from pymodbus.constants import ExcCodes

from simulators.plant import Row
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer, node_of

TS = 0.1
"""s"""
LOOPS = {"FIC101": ("pv", "op")}
TURN = 1000.0
"""PV is the time modulo this, s: a value tells when it was measured."""


def truth(at):
    """Return PV and OP at a time, s UTC."""
    return {"pv": at % TURN, "op": at / 2 % TURN}


class Plant:
    """What is served, and what was done to it."""

    def __init__(self, bus, port):
        self.offset = 0.0
        self.removed = False
        self.server = {"modbus": ModbusServer, "opcua": OpcUaServer, "mqtt": MqttServer}[bus](
            LOOPS, port=port
        )

    async def run(self):
        """Put a row every TS seconds."""
        while True:
            try:
                async with self.server:
                    self._answer_refusals()
                    sys.stdout.write(f"{self.server.port}\n")
                    sys.stdout.flush()
                    while True:
                        await self._put()
                        await asyncio.sleep(TS)
            except (OSError, MqttError):
                if not isinstance(self.server, MqttServer):
                    raise
                await asyncio.sleep(0.05)  # the broker is not there

    async def _put(self):
        at = time.time() + self.offset
        for loop in LOOPS:
            if not self.removed or isinstance(self.server, ModbusServer):
                await self.server.put(loop, Row(at, truth(at)))

    def _answer_refusals(self):
        """Have a Modbus device refuse what was removed."""
        if not isinstance(self.server, ModbusServer):
            return

        async def answer(_function, _start, _address, _count, _registers, values):
            return ExcCodes.ILLEGAL_ADDRESS if self.removed and values is None else None

        for device in self.server._server.context.devices.values():
            device.action = answer

    async def obey(self, order, *words):
        """Do what a line on stdin says."""
        if order == "clock":
            self.offset += float(words[0])
            return
        self.removed = order == "remove"
        if isinstance(self.server, OpcUaServer):
            nodes = [self.server._server.get_node(node_of("FIC101", role)) for role in LOOPS["FIC101"]]
            if self.removed:
                await self.server._server.delete_nodes(nodes)
            else:
                for node in nodes:
                    await self.server._server.nodes.objects.add_variable(
                        node.nodeid, "2:again", ua.Variant(0.0, ua.VariantType.Double)
                    )


async def main(bus, port):
    plant = Plant(bus, port)
    feeding = asyncio.create_task(plant.run())
    lines = asyncio.StreamReader()
    await asyncio.get_running_loop().connect_read_pipe(lambda: asyncio.StreamReaderProtocol(lines), sys.stdin)
    while line := await lines.readline():
        await plant.obey(*line.decode().split())
        sys.stdout.write("done\n")
        sys.stdout.flush()
    feeding.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await feeding


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], int(sys.argv[2])))
