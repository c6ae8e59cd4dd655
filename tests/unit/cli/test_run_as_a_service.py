"""`slipjump run` as systemd starts it: its news, how it takes over a changed file, and that it is alone."""

import json
import os
import signal
import socket
import subprocess
import time

import pytest
import yaml

from tests.ports import free_port
from tests.unit.cli.test_run_and_check import plant, slipjump
from tests.unit.runtime.test_http import get

__all__ = ["plant"]
pytestmark = pytest.mark.timeout(240)
DEADLINE = 60.0
"""s; a busy machine takes its time."""


class Service:
    """A daemon, what systemd hears from it, and what it logs."""

    def __init__(self, config, *words):
        self.news = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        address = str(config.parent / "notify")
        self.news.bind(address)
        self.news.settimeout(DEADLINE)
        environment = os.environ | {"NOTIFY_SOCKET": address, "WATCHDOG_USEC": "3000000"}
        self.process = subprocess.Popen(
            slipjump("run", config, *words), stderr=subprocess.PIPE, text=True, env=environment
        )
        self.said = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.process.stderr.close()
        self.news.close()

    def hears(self, news):
        """Wait until systemd is told ``news``; return the lines it came with."""
        deadline = time.monotonic() + DEADLINE
        while time.monotonic() < deadline:
            lines = self.news.recv(4096).decode().splitlines()
            if news in lines:
                return lines
        pytest.fail(f"systemd was not told {news}")

    def says(self, part):
        """Wait for a line of the log with ``part`` in its message."""
        for line in self.process.stderr:
            self.said.append(json.loads(line))
            if part in self.said[-1]["message"]:
                return self.said[-1]
        return pytest.fail(f"it ended and did not say {part!r}: {self.said}")


def test_a_service_from_start_to_end(plant):
    content, port = yaml.safe_load(plant.read_text()), free_port()
    content["agent"] = {"http": {"port": port}}
    plant.write_text(yaml.safe_dump(content))
    with Service(plant, "--log-format", "json") as service:
        assert "STATUS=watching 1 loop on 1 connection" in service.hears("READY=1")
        service.hears("WATCHDOG=1")
        assert service.says("connection unit1 is down")["connection"] == "unit1"
        code, health = get(port, "/health")
        assert (code, json.loads(health)["connections"]["unit1"]["up"]) == (503, False)
        assert get(port, "/live") == (200, "ok\n")

        second = subprocess.run(slipjump("run", plant), capture_output=True, text=True, check=False)
        told = f"is used by another agent, process {service.process.pid}"
        assert (second.returncode, second.stderr) == (
            2,
            f"slipjump: {plant.with_suffix('.sqlite')}: {told}\n",
        )

        loop = content["loops"][0]
        plant.write_text(yaml.safe_dump(content | {"loops": [loop | {"ts": "often"}, {}]}))
        service.process.send_signal(signal.SIGHUP)
        assert service.hears("RELOADING=1")[1].startswith("MONOTONIC_USEC=")
        service.hears("READY=1")
        assert service.says(": ts: ")["event"] == "refused"
        service.says("the agent continues with its previous settings")
        assert list(json.loads(get(port, "/health")[1])["loops"]) == ["FIC101"]

        plant.write_text(yaml.safe_dump(content | {"loops": [loop, loop | {"name": "FIC102"}]}))
        service.process.send_signal(signal.SIGHUP)
        assert "STATUS=watching 2 loops on 1 connection" in service.hears("READY=1")
        service.says("1 of 2 loops and 1 of 1 connections are new or changed")
        assert list(json.loads(get(port, "/health")[1])["loops"]) == ["FIC101", "FIC102"]

        service.process.terminate()
        service.hears("STOPPING=1")
        service.says("stopped")
        assert service.process.wait(DEADLINE) == 0
    assert {"time", "level", "message"} <= set.intersection(*(set(line) for line in service.said))
