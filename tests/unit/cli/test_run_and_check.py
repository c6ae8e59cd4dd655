"""`slipjump run` and `slipjump check` as a user starts them."""

import os
import signal
import subprocess
import sys
import time

import pytest
import yaml

from tests.conftest import ROOT
from tests.ports import free_port


def slipjump(*words):
    return [sys.executable, "-c", "from agent.cli import main; main()", *map(str, words)]


@pytest.fixture
def plant(tmp_path):
    """A configuration whose peer isn't there: a port that was free a moment ago."""
    port = free_port()
    path = tmp_path / "plant.yaml"
    path.write_text(
        yaml.safe_dump(
            {
                "connections": {"unit1": {"kind": "modbus", "port": port}},
                "loops": [
                    {
                        "name": "FIC101",
                        "connection": "unit1",
                        "ts": 1.0,
                        "tags": {
                            "pv": {"table": "holding", "address": 0},
                            "op": {"table": "holding", "address": 2},
                        },
                    }
                ],
            }
        )
    )
    return path


def test_only_libraries_of_its_own_buses_are_loaded(plant):
    program = """if True:
        import sys
        from pathlib import Path
        import agent.runtime.agent, agent.runtime.operate.http, agent.runtime.operate.reload
        from agent.settings import load_settings
        load_settings(Path(sys.argv[1]))  # which makes the connectors
        libraries = ("pymodbus", "asyncua", "aiomqtt", "google.protobuf")
        print(*(each for each in libraries if each in sys.modules))
    """
    loaded = subprocess.run(
        [sys.executable, "-c", program, plant], capture_output=True, text=True, check=True
    )
    assert loaded.stdout.split() == ["pymodbus"]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_run_ends_well_within_five_seconds_of_a_signal_and_leaves_no_process(plant, number):
    with subprocess.Popen(
        slipjump("run", plant), stderr=subprocess.PIPE, text=True, cwd=plant.parent, start_new_session=True
    ) as process:
        assert process.stderr is not None
        said = []
        for line in process.stderr:
            said.append(line)
            if "is down" in line:
                break
        began = time.monotonic()
        process.send_signal(number)
        said += process.stderr.readlines()
        assert process.wait(timeout=10) == 0
        assert time.monotonic() - began < 5
    assert "watching 1 loop on 1 connection" in said[0]
    assert "stopped" in said[-1], "".join(said)
    assert "Traceback" not in "".join(said)
    deadline = time.monotonic() + 30
    while group_alive(process.pid):
        assert time.monotonic() < deadline, "a process of the agent is still there"
        time.sleep(0.05)


def group_alive(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_check_says_what_run_would_do():
    done = subprocess.run(
        slipjump("check", ROOT / "config" / "example.yaml"), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "FIC101: pv, op, sp, mv, mode from unit1 every 1 s" in done.stdout
    assert "windows of 3000 s, alarm to dcs" in done.stdout


@pytest.mark.parametrize("command", ["check", "run"])
def test_all_faults_of_a_file_are_reported_one_a_line(plant, command):
    content = yaml.safe_load(plant.read_text())
    content["loops"][0]["ts"] = "often"
    content["connections"]["unit1"]["port"] = 0
    plant.write_text(yaml.safe_dump(content))
    done = subprocess.run(slipjump(command, plant), capture_output=True, text=True, check=False)
    assert done.returncode == 2
    lines = done.stderr.splitlines()
    assert len(lines) == 2
    assert all(f"{plant}, line " in line for line in lines)
    assert "connection unit1: port: " in lines[0]
    assert f"loop {content['loops'][0]['name']}: ts: " in lines[1]


def test_check_connect_says_that_the_peer_is_not_there(plant):
    done = subprocess.run(
        slipjump("check", plant, "--connect", "--within", "3"), capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stdout.startswith("unit1 (modbus): unreachable: ")
    assert done.stdout.count("not read: no connection") == 2
    assert "Traceback" not in done.stderr
