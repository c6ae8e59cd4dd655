"""`slipjump browse mqtt://`: loops of a broker are found by what is published there, and can be watched."""

import asyncio
import json
import time
from contextlib import asynccontextmanager

import pytest

from agent.cli import main
from agent.runtime.commission.published_loops import find_published_loops
from agent.settings import load_settings
from connectors.base import ConnectionLostError
from connectors.cancellation import obey_cancellation
from connectors.mqtt.client import Outgoing, connected
from connectors.mqtt.heard import hear
from connectors.mqtt.options import MqttOptions
from tests.integration.buses import mosquitto_broker
from tests.integration.command import slipjump
from tests.integration.secure_peers import PASSWORD, make_keys, secure_broker

MANY = 1000
"""Topics, more than there are."""


def row(name, value):
    return {"id": f"Plant.{name}", "v": value, "q": True, "t": round(1000 * time.time())}


@asynccontextmanager
async def publishing(port):
    """A gateway that publishes changes, one tag a message, until the end."""

    async def publish():
        async with connected(MqttOptions(port=port)) as client:
            while True:
                obey_cancellation()
                for name, value in (("FIC1.PV", 4.2), ("FIC1.OP", 51.0), ("TIC2.PV", 7.0)):
                    payload = json.dumps({"timestamp": 1, "values": [row(name, value)]}).encode()
                    await client.send(Outgoing("kepware", payload))
                await client.send(Outgoing("plant/LIC3/PV", b"12.5"))
                await client.send(Outgoing("plant/LIC3/OP", b"33"))
                await asyncio.sleep(0.05)

    task = asyncio.create_task(publish())
    try:
        yield
    finally:
        task.cancel()
        await asyncio.wait([task])


async def test_the_loops_of_a_broker_are_written_to_a_configuration_that_works(mosquitto, tmp_path):
    out = tmp_path / "plant.yaml"
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), publishing(port):
        browse = ("browse", f"mqtt://127.0.0.1:{port}", "--within", "2", "-o", str(out), "--json")
        code, shown, faults = await slipjump(*browse)
        assert code == 0, faults
        loops = {each["loop"]: each["tags"] for each in map(json.loads, shown.splitlines())}
        assert loops.keys() == {"FIC1", "LIC3"}
        assert loops["FIC1"]["op"]["value"] == 51.0
        assert load_settings(out).loops[0].tags["pv"].where == {"id": "Plant.FIC1.PV"}
        code, checked, _ = await slipjump("check", str(out), "--connect")
    assert code == 0
    assert "0 with a problem" in checked


async def test_an_encrypted_broker_is_heard_and_its_configuration_holds_no_secret(mosquitto, tmp_path):
    (tmp_path / "keys").mkdir()
    keys = make_keys(tmp_path / "keys")
    (tmp_path / "password").write_text(PASSWORD)
    login = {"user": "agent", "password": {"file": str(tmp_path / "password")}}
    tls = {
        "ca": str(keys / "ca.pem"),
        "certificate": str(keys / "client.pem"),
        "key": str(keys / "client-key.pem"),
    }
    out = tmp_path / "plant.yaml"
    async with secure_broker(mosquitto, tmp_path, keys, ask=True) as port:
        options = MqttOptions.model_validate({"port": port, "tls": tls, **login})
        async with connected(options) as client:
            for role, value in (("PV", b"1.5"), ("OP", b"50")):
                await client.send(Outgoing(f"plant/FIC1/{role}", value, retain=True))
        files = [word for key, path in tls.items() for word in (f"--{key}", path)]
        known = ["--user", "agent", "--password-file", tmp_path / "password"]
        browse = ["browse", f"mqtts://127.0.0.1:{port}", "--within", "1", "-o", out]
        code, shown, faults = await slipjump(*browse, *files, *known)
        assert (code, faults) == (0, "")
        code, _, _ = await slipjump(*browse[:-1], tmp_path / "other.yaml", *files)
        assert code == 2
    assert "FIC1" in shown
    assert PASSWORD not in out.read_text() + shown
    assert load_settings(out).connections["dcs"].options == options


async def test_hearing_ends_at_each_of_its_bounds(mosquitto, tmp_path):
    async with mosquitto_broker(mosquitto, tmp_path) as (port, _), publishing(port):
        options = MqttOptions(port=port)
        assert (await hear(options, "#", 30.0, most_topics=1)).stopped == "1 topics"
        only = await find_published_loops(options, "plant/#", 1.0, MANY)
        assert [each.name for each in only.loops] == ["LIC3"]
        assert (only.nodes, only.variables, only.stopped) == (2, 2, None)
        by_pattern = {"pv": "Plant.*.PV", "op": "Plant.*.OP"}
        named = await find_published_loops(options, "#", 1.0, MANY, by_pattern)
        assert [each.name for each in named.loops] == ["FIC1"]


async def test_a_broker_that_is_gone_is_reported():
    with pytest.raises(ConnectionLostError, match="MQTT broker at"):
        await hear(MqttOptions(port=9), "#", 1.0, MANY)


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        (["http://127.0.0.1"], "http://127.0.0.1: expected opc.tcp://HOST:PORT, mqtt://HOST:PORT or mqtts"),
        (["mqtt://h:9/plant"], "mqtt://h:9/plant: expected mqtt://HOST:PORT; topics by --root"),
        (["mqtt://me:secret@h"], "mqtt://h: expected mqtt://HOST:PORT"),
        (["mqtt://h:99999"], "mqtt://h:99999: expected mqtt://HOST:PORT"),
        (["mqtt://h", "--ca", "ca.pem"], "mqtt://h: files for TLS, but only mqtts:// is encrypted"),
        (["mqtts://h", "--policy", "None"], "--policy: only of OPC UA"),
        (["mqtt://h", "--password-env", "X"], "a password needs its user"),
    ],
)
def test_what_is_wrong_is_reported_in_one_line(words, fault, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["browse", *words])
    assert ended.value.code == 2
    assert fault in capsys.readouterr().err.splitlines()[0]
