"""Each capability of the system is taken away, and its work is done another way."""

from __future__ import annotations

import asyncio
import fcntl
import multiprocessing
import os
import signal
import socket
from types import SimpleNamespace

import pytest

from agent.runtime import capabilities
from agent.runtime.operate.notify import ServiceManager
from agent.runtime.store.lock import only_agent_of
from connectors.base import ConfigError
from connectors.reuse import listen_again


def by_bytes(handle, mode, count):
    """What ``msvcrt.locking`` does, by means of this system."""
    assert mode == 2
    try:
        fcntl.lockf(handle, fcntl.LOCK_EX | fcntl.LOCK_NB, count, os.lseek(handle, 0, os.SEEK_CUR))
    except BlockingIOError as error:
        raise PermissionError(13, "Permission denied") from error


def test_cores_without_affinity(monkeypatch):
    assert capabilities.cores() == len(os.sched_getaffinity(0))
    monkeypatch.delattr(os, "sched_getaffinity")
    assert capabilities.cores() == os.cpu_count()
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert capabilities.cores() == 1


def test_processes_without_a_fork_server(monkeypatch):
    assert capabilities.start_method() == "forkserver"
    monkeypatch.setattr(multiprocessing, "get_all_start_methods", lambda: ["spawn"])
    assert capabilities.start_method() == "spawn"
    capabilities.import_before_start(multiprocessing.get_context("spawn"), ["agent.units"])  # is no fault


def test_no_nice(monkeypatch):
    monkeypatch.delattr(os, "nice")
    capabilities.step_back(5)


@pytest.mark.parametrize("handlers", [True, False])
async def test_signals_with_and_without_handlers_of_the_event_loop(monkeypatch, handlers):
    loop, come = asyncio.get_running_loop(), asyncio.Event()
    if not handlers:

        def refuse(*_):
            raise NotImplementedError

        monkeypatch.setattr(loop, "add_signal_handler", refuse)
    before = signal.getsignal(signal.SIGUSR1)
    try:
        capabilities.on_signals({"SIGUSR1": come.set, "SIGBREAK": come.set})
        os.kill(os.getpid(), signal.SIGUSR1)
        async with asyncio.timeout(10):
            await come.wait()
    finally:
        loop.remove_signal_handler(signal.SIGUSR1)
        signal.signal(signal.SIGUSR1, before)


async def test_a_signal_that_does_not_exist_is_left_out(monkeypatch):
    monkeypatch.delattr(signal, "SIGHUP")
    capabilities.on_signals({"SIGHUP": lambda: None})


def test_an_event_loop_that_watches_sockets_where_the_usual_one_cannot(monkeypatch):
    async def kind():
        return type(asyncio.get_running_loop())

    monkeypatch.setattr(asyncio, "ProactorEventLoop", object, raising=False)
    assert issubclass(capabilities.run_event_loop(kind()), asyncio.SelectorEventLoop)


@pytest.mark.parametrize("way", ["flock", "bytes", "none"])
def test_one_agent_per_state_file(monkeypatch, tmp_path, way, caplog):
    state = tmp_path / "state.sqlite"
    if way != "flock":
        monkeypatch.setattr(capabilities, "fcntl", None)
    if way == "bytes":
        monkeypatch.setattr(capabilities, "msvcrt", SimpleNamespace(LK_NBLCK=2, locking=by_bytes))
    with only_agent_of(state):
        assert (way == "none") == ("cannot check" in caplog.text)
        locked = os.fork()  # locks of bytes belong to a process: another one has to try
        if not locked:
            try:
                with only_agent_of(state):
                    os._exit(0)
            except ConfigError:
                os._exit(7)
        _, status = os.waitpid(locked, 0)
        assert os.waitstatus_to_exitcode(status) == (0 if way == "none" else 7)
    with only_agent_of(state):
        pass


def test_no_service_manager_without_unix_sockets(monkeypatch):
    monkeypatch.delattr(socket, "AF_UNIX")
    ServiceManager("/run/systemd/notify").ready("works")


def test_ports_that_nobody_takes_over(monkeypatch):
    options = []
    monkeypatch.setattr(socket, "SO_EXCLUSIVEADDRUSE", -5, raising=False)
    listen_again(SimpleNamespace(setsockopt=lambda *each: options.append(each)))
    assert options == [(socket.SOL_SOCKET, -5, 1)]
