"""`slipjump check --connect` as a user starts it, on plants with faults: each is told in plain words."""

import asyncio
import json
import math
import time
from contextlib import AsyncExitStack

import yaml

from simulators.plant import Row
from tests.integration.buses import serving
from tests.integration.command import slipjump

ROLES = ("pv", "op", "sp", "mode")


async def keep_moving(server, loop, values, behind=0.0):
    while True:
        now = time.time()
        moving = {**values, "pv": values["pv"] + math.sin(9 * now)}
        await server.put(loop, Row(now - behind, moving))
        await asyncio.sleep(0.05)


async def test_each_fault_of_a_plant_is_reported(tmp_path):
    good = {"pv": 50.0, "op": 40.0, "sp": 50.0, "mode": "AUTO"}
    async with AsyncExitStack() as stack:
        modbus, opcua, mqtt = [
            await stack.enter_async_context(serving(bus, {"F1": ROLES}))
            for bus in ("modbus", "opcua", "mqtt")
        ]
        tasks = await stack.enter_async_context(asyncio.TaskGroup())
        moving = [
            tasks.create_task(keep_moving(modbus, "F1", {**good, "op": 4000.0})),
            tasks.create_task(keep_moving(opcua, "F1", {**good, "op": math.nan})),
            tasks.create_task(keep_moving(mqtt, "F1", good, behind=7200.0)),
        ]
        servers = {"modbus": modbus, "opcua": opcua, "mqtt": mqtt}
        loops = {bus: server.loop_settings("F1", 1.0) for bus, server in servers.items()}
        for bus, loop in loops.items():
            loop |= {
                "name": f"F_{bus}",
                "op_range": [0, 100],
                "pv_range": [0, 100],
                "publish": loop["publish"],
            }
        # what a person gets wrong
        loops["modbus"]["tags"]["mv"] = {"table": "holding", "address": 4000}
        loops["modbus"]["publish"][0]["active"]["address"] = 4000
        loops["opcua"]["tags"]["mv"] = {"node": "ns=2;s=nowhere"}
        loops["opcua"]["publish"][0]["fields"] = {"s": {"node": "ns=2;s=F1.PV"}}
        loops["mqtt"]["tags"]["op"] = loops["mqtt"]["tags"]["mode"]
        config = tmp_path / "plant.yaml"
        connections = {server.name: server.connection_settings() for server in (modbus, opcua, mqtt)}
        connections["gone"] = {"kind": "modbus", "port": 9}
        tags = {role: {"table": "input", "address": 0} for role in ("pv", "op")}
        gone = {"name": "F_gone", "connection": "gone", "ts": 1.0, "tags": tags}
        config.write_text(yaml.safe_dump({"connections": connections, "loops": [*loops.values(), gone]}))
        try_it = ("check", config, "--connect", "--within", "30", "--watch", "0.3")
        (code, out, err), table = await asyncio.gather(slipjump(*try_it, "--json"), slipjump(*try_it))
        for task in moving:
            task.cancel()
    assert (code, err) == (2, "")
    found = {
        (each.get("loop", each["connection"]), each.get("role", each.get("place"))): each
        for each in map(json.loads, out.splitlines())
    }

    def problem(loop, place):
        return " ".join(found[loop, place]["problems"])

    for bus in ("modbus", "opcua", "mqtt"):
        assert problem(bus, None) == ""
        assert problem(f"F_{bus}", "pv") == ""
        assert abs(found[f"F_{bus}", "pv"]["value"] - 50) < 1.1
    assert problem("gone", None).startswith("unreachable: ")
    assert problem("F_gone", "pv").startswith("not read")
    assert problem("F_modbus", "op").startswith("outside op_range")
    assert problem("F_modbus", "mv") == "Modbus exception 2, it has no such address"
    assert problem("F_modbus", "coil 4000") == "Modbus exception 2, it has no such address"
    assert problem("F_opcua", "op").startswith("BadSensorFailure")
    assert problem("F_opcua", "mv").startswith("BadNodeIdUnknown")
    assert problem("F_opcua", "ns=2;s=F1.PV") == "this user may not write it"
    assert problem("F_opcua", "ns=2;s=F1.STICTION") == ""
    assert problem("F_mqtt", "") == ""
    assert problem("F_mqtt", "op") == "the message has the text 'AUTO' where a number belongs"
    assert abs(found["F_mqtt", "pv"]["age_s"] - 7200) < 60
    assert found["F_mqtt", "pv"]["remarks"][0].startswith("its source time is 2 h old")
    code, out, _ = table
    assert code == 2
    assert "LOOP      TAG" in out
    assert "F_modbus  op    4000 " in out
    assert out.splitlines()[-1].startswith("16 tags, ")
