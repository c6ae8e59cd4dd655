"""Our OPC UA server and the alarm list of node-opcua, which somebody else wrote after the same standard.

Not in ``make test``: it takes half a minute and the npm registry to install.
"""

import asyncio
import json
import shutil
from pathlib import Path

import pytest

from tests.integration.opcua_served import serving

PEER = Path(__file__).with_name("node_opcua_alarms.js")
STATES = {"acknowledge": "acked_active", "shelve": "shelved"}


async def run(*command, **options):
    process = await asyncio.create_subprocess_exec(
        *command, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT, **options
    )
    output, _ = await process.communicate()
    assert process.returncode == 0, output.decode()
    return output.decode()


@pytest.mark.bench
@pytest.mark.timeout(600)
async def test_node_opcua_sees_acknowledges_and_shelves(tmp_path):
    for tool in ("node", "npm"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is missing")
    await run("npm", "install", "--no-audit", "--no-fund", "node-opcua-client@2.186.4", cwd=tmp_path)
    shutil.copy(PEER, tmp_path)

    async with serving(anonymous="order") as served:
        await served.become("FIC101", "unacked_active")
        url = f"opc.tcp://127.0.0.1:{served.port}"
        peer = asyncio.create_task(run("node", PEER.name, url, cwd=tmp_path))
        orders = []
        while len(orders) < 2 and not peer.done():
            orders.append(await served.order())
            await served.become("FIC101", STATES[orders[-1].action], by=orders[-1].by, until=orders[-1].until)
        (line,) = [line for line in (await peer).splitlines() if line.startswith("TOLD ")]
    assert json.loads(line.removeprefix("TOLD ")) == {
        "condition": "ns=2;s=FIC101.Alarm",
        "message": "FIC101: valve sticks: S 4, J 1",
        "answers": ["BadEventIdUnknown", "Good", "Good"],
        "comment": "seen",
    }
    assert [order.action for order in orders] == ["acknowledge", "shelve"]
    assert orders[0].by == "third party (127.0.0.1)"
