"""What systemd is told, at a real socket."""

import os
import socket

import pytest

from agent.runtime.operate.notify import ServiceManager


@pytest.fixture(params=["file", "abstract"])
def manager(request, tmp_path):
    """A socket as systemd has it, and its address in the environment."""
    address = str(tmp_path / "notify") if request.param == "file" else f"@slipjump/{os.getpid()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as heard:
        heard.bind(address.replace("@", "\0", 1))
        heard.settimeout(5)
        yield heard, {"NOTIFY_SOCKET": address, "WATCHDOG_USEC": "30000000", "WATCHDOG_PID": str(os.getpid())}


def test_it_is_reported_all_there_is_to_report(manager):
    heard, environment = manager
    service = ServiceManager.of(environment)
    assert service.watchdog == 30.0
    service.ready("watching 3 loops")
    service.alive()
    service.reloading()
    service.stopping()
    told = [heard.recv(4096).decode().splitlines() for _ in range(4)]
    assert told[0] == ["READY=1", "STATUS=watching 3 loops"]
    assert told[1] == ["WATCHDOG=1"]
    assert told[2][0] == "RELOADING=1"
    assert told[2][1].removeprefix("MONOTONIC_USEC=").isdigit()
    assert told[3] == ["STOPPING=1"]


@pytest.mark.parametrize(
    ("environment", "watchdog"),
    [
        ({}, None),
        ({"NOTIFY_SOCKET": "vsock:2:1234", "WATCHDOG_USEC": "30000000"}, None),
        ({"NOTIFY_SOCKET": "/nobody/listens", "WATCHDOG_USEC": "1500000"}, 1.5),
        ({"NOTIFY_SOCKET": "/nobody/listens", "WATCHDOG_USEC": "30000000", "WATCHDOG_PID": "1"}, None),
        ({"NOTIFY_SOCKET": "/nobody/listens", "WATCHDOG_USEC": "soon"}, None),
    ],
)
def test_without_systemd_nothing_happens(environment, watchdog):
    service = ServiceManager.of(environment)
    assert service.watchdog == watchdog
    service.ready("")
    service.alive()
