"""`slipjump browse`: the loops of a server are found by their names, within bounds, and can be watched."""

import asyncio
import json
from contextlib import asynccontextmanager

import pytest
import yaml
from asyncua import Client, Server, ua

from agent.cli import main
from agent.cli.browsing.shown import write
from agent.runtime.commission.found_loops import FoundLoop, LoopSearch
from agent.runtime.commission.probe import probe
from agent.settings import load_settings
from connectors.base import ConnectionLostError
from connectors.opcua.browse import Bounds, walk
from tests.integration.command import slipjump

PLANT = [
    "A1/FIC101/PID1/PV.CV",
    "A1/FIC101/PID1/OUT.CV",
    "A1/FIC101/PID1/SP.CV",
    "A1/FIC101/PID1/MODE.ACTUAL",
    "A2/TIC7/PV",
    "A2/TIC7/OP",
    "A2/TIC7/MODE",
    "A2/TI8/PV",
    "A2/XV9/PV",
    "A2/XV9/OP",
]
FLAT = ["LIC3.MEAS", "LIC3.OUT", "LIC3.SPT"]


@asynccontextmanager
async def serving():
    server = Server()
    await server.init()
    server.set_endpoint("opc.tcp://127.0.0.1:0")
    server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
    await server.register_namespace("urn:test")
    folders = {(): server.nodes.objects}
    for name in PLANT:
        *above, last = name.split("/")
        for depth in range(1, len(above) + 1):
            path = tuple(above[:depth])
            if path not in folders:
                id_ = ua.NodeId("/".join(path), 2)
                folders[path] = await folders[path[:-1]].add_object(id_, f"2:{path[-1]}")
        # a valve that is called as a loop and says words
        value = "AUTO" if "MODE" in last else "OPEN" if "XV9" in above else 40.0
        node = await folders[tuple(above)].add_variable(ua.NodeId(name, 2), f"2:{last}", value)
        if name == "A2/TIC7/PV":
            await node.add_property(2, "EURange", ua.Range(0.0, 250.0))
    data = await server.nodes.objects.add_object(ua.NodeId("Data", 2), "2:Data")
    for number, name in enumerate(FLAT):  # a gateway: the names are in the ids alone
        await data.add_variable(ua.NodeId(name, 2), f"2:Value{number}", 1.0)
    # a circle
    await folders["A1", "FIC101"].add_reference(folders["A1",], ua.ObjectIds.Organizes)
    await server.start()
    server.port = server.bserver.port
    try:
        yield server
    finally:
        await server.stop()


@asynccontextmanager
async def client_of_plant():
    async with serving() as server, Client(f"opc.tcp://127.0.0.1:{server.port}") as client:
        yield client


async def test_the_loops_are_found_and_the_configuration_can_be_watched(tmp_path):
    config = tmp_path / "plant.yaml"
    async with serving() as server:
        url = f"opc.tcp://127.0.0.1:{server.port}"
        (code, out, err), (_, table, _) = await asyncio.gather(
            slipjump("browse", url, "-o", config, "--ts", "2", "--json"),
            slipjump("browse", url, "--pv", "*.MEAS", "--op", "*.OUT"),
        )
        assert code == 0, err
        findings = await probe(load_settings(config), within=30.0)
    found = {each["loop"]: each for each in map(json.loads, out.splitlines())}
    assert found.keys() == {"FIC101", "TIC7", "LIC3"}
    assert found["TIC7"]["tags"]["pv"] == {"node": "ns=2;s=A2/TIC7/PV", "value": 40.0, "range": [0.0, 250.0]}
    loops = {loop.name: loop for loop in load_settings(config).loops}
    assert loops["FIC101"].roles == ("pv", "op", "sp", "mode")
    assert loops["FIC101"].tags["mode"].node == "ns=2;s=A1/FIC101/PID1/MODE.ACTUAL"
    assert loops["LIC3"].tags["op"].node == "ns=2;s=LIC3.OUT"
    assert (loops["TIC7"].ts, loops["TIC7"].pv_range) == (2.0, (0.0, 250.0))
    assert [each.problems for each in findings] == [()] * len(findings)
    assert "LIC3  *.MEAS, *.OUT  1   1   ns=2;s=LIC3.MEAS  ns=2;s=LIC3.OUT" in table
    assert table.splitlines()[-1].endswith(" 1 loops")


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (["-o", "{there}"], "{there}: exists already; remove it, or name another file"),
        (["--user", "me", "--password-env", "X"], "login needs security: without, nobody knows who gets"),
        (["--certificate", "c.pem"], "security.key: is missing"),
        (["--pv", "*.PV"], "Invalid value for '--pv' / '--op': --pv and --op belong together"),
        (["--pv", "PV"], "Invalid value for '--pv': expected a name with one *"),
        ([], "OPC UA server at opc.tcp://127.0.0.1:9: "),
    ],
)
def test_what_is_wrong_is_reported_in_one_line(words, fault, tmp_path, capsys):
    there = tmp_path / "plant.yaml"
    there.write_text("mine")
    with pytest.raises(SystemExit) as ended:
        main(["browse", "opc.tcp://127.0.0.1:9", *(word.format(there=there) for word in words)])
    assert ended.value.code == 2
    told = capsys.readouterr().err.splitlines()
    assert told[0].startswith("slipjump: " + fault.format(there=there))
    assert there.read_text() == "mine"


async def test_a_walk_ends_at_each_of_its_bounds_and_in_circles():
    async with client_of_plant() as client:
        whole = await walk(client, Bounds())
        assert whole.stopped is None
        assert len(whole.variables) == len(PLANT) + len(FLAT) + 2  # EURange, and Aliases has one
        assert (await walk(client, Bounds(depth=2))).stopped == "2 levels"
        assert (await walk(client, Bounds(nodes=5))).stopped == "5 nodes"
        assert (await walk(client, Bounds(seconds=-1.0))).stopped == "-1 s"
        below = await walk(client, Bounds(), "ns=2;s=A2/TIC7")
        assert {each.path for each in below.variables} == {("PV",), ("OP",), ("MODE",), ("PV", "EURange")}
        for wrong in ("ns=2;s=nowhere", "nonsense"):
            with pytest.raises(ConnectionLostError):
                await walk(client, Bounds(), wrong)


async def test_a_server_of_small_answers_is_requested_in_small_pieces(monkeypatch):
    """One node a request, and answers that go on in further ones: the same is found."""
    async with client_of_plant() as client:
        whole = await walk(client, Bounds())
        browse, rest, asked = client.uaclient.browse, {}, []

        async def small(wanted):
            asked.append(len(wanted.NodesToBrowse))
            if len(wanted.NodesToBrowse) > 1:
                raise ua.UaStatusCodeError(ua.StatusCodes.BadTooManyOperations)
            results = await browse(wanted)
            for result in results:
                if len(result.References) > 1:
                    result.ContinuationPoint = b"%d" % len(rest)
                    rest[result.ContinuationPoint] = result.References[1:]
                    result.References = result.References[:1]
            return results

        async def more(wanted):
            (point,) = wanted.ContinuationPoints
            first, *others = rest.pop(point)
            if others:
                rest[point] = others
            return [ua.BrowseResult(References=[first], ContinuationPoint=point if others else None)]

        monkeypatch.setattr(client.uaclient, "browse", small)
        monkeypatch.setattr(client.uaclient, "browse_next", more)
        pieces = await walk(client, Bounds())
    assert max(asked) > 1
    assert asked[-1] == 1
    assert pieces == whole


def test_what_is_written_is_yaml_that_a_person_reads(tmp_path):
    loop = FoundLoop("F1", "x", {"pv": {"node": "i=1"}, "op": {"node": "i=2"}}, {}, {"op": (0.0, 100.0)})
    path = tmp_path / "plant.yaml"
    entry = {
        "kind": "opcua",
        "url": "opc.tcp://h:1",
        "security": {"certificate": "c", "key": "k", "ca": "a"},
        "login": {"user": "me", "password": {"env": "PASSWORD"}},
    }
    write(path, "opc.tcp://h:1", entry, LoopSearch((loop,), 2, 2, None), 5.0)
    assert yaml.safe_load(path.read_text())["connections"] == {"dcs": entry}
    assert load_settings(path).loops[0].op_range == (0.0, 100.0)
