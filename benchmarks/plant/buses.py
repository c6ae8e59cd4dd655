"""The buses of a plant: what serves its values, how a configuration names them, and a bare client of each."""

from __future__ import annotations

import contextlib
import multiprocessing
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.plant import bare
from benchmarks.plant.bare import PATIENT
from benchmarks.plant.broker import free_port, mosquitto, publish, topic
from benchmarks.plant.modbus_source import REGISTERS, serve_modbus
from benchmarks.plant.opcua_source import node, serve_opcua
from benchmarks.plant.values import ROLES

CONTEXT = multiprocessing.get_context("spawn")
AN_HOUR = 3600.0
"""Longer than any run, s."""
STARTS = 120.0
"""Longest time until a server listens, s."""


@dataclass(frozen=True)
class Bus:
    """One way from the plant to its readers."""

    key: str
    """Of its connection."""
    name: str
    serve: Callable[[Path, list[str]], AbstractContextManager[int]]
    """Serves the loops of these names, given a folder; yields the port."""
    connection: Callable[[int], dict[str, Any]]
    """The entry of ``connections``, by the port."""
    cell: Callable[[int, str, str], str]
    """The address of a role in the list of loops: of the loop of this number and name."""
    bare: Callable[..., None]
    """Reads the port and loops of this number with the bus's library alone."""
    tags: Mapping[str, Any] = field(default_factory=dict)
    """Defaults of each tag."""


@contextlib.contextmanager
def _broker(folder: Path, names: list[str]) -> Iterator[int]:
    with mosquitto(folder) as port, _process(publish, port, names, time.time() + AN_HOUR):
        yield port


@contextlib.contextmanager
def _modbus(_: Path, names: list[str]) -> Iterator[int]:
    port = free_port()
    with _process(serve_modbus, port, len(names), wait=True):
        yield port


@contextlib.contextmanager
def _opcua(_: Path, names: list[str]) -> Iterator[int]:
    port = free_port()
    with _process(serve_opcua, port, names, wait=True):
        yield port


@contextlib.contextmanager
def _process(serve: Callable[..., Any], *args: object, wait: bool = False) -> Iterator[None]:
    """Run a server in a process of its own; with ``wait`` until it sets an event, its last argument."""
    listens = CONTEXT.Event()
    process = CONTEXT.Process(target=serve, args=(*args, *([listens] if wait else [])), daemon=True)
    process.start()
    try:
        if wait and not listens.wait(STARTS):
            raise RuntimeError(f"{serve.__name__} did not start")
        yield
    finally:
        process.kill()
        process.join()


MQTT = Bus(
    key="mqtt",
    name="MQTT, a message a loop",
    serve=_broker,
    connection=lambda port: {"kind": "mqtt", "port": port},
    cell=lambda _, loop, role: f"{topic(loop)}#{role}",
    bare=bare.mqtt,
    tags={"time_field": "t"},
)
MODBUS = Bus(
    key="modbus",
    name="Modbus, neighbours in one read",
    serve=_modbus,
    connection=lambda port: {"kind": "modbus", "port": port, "poll": 1.0, "requests": 4},
    cell=lambda number, _, role: f"holding {(number * len(ROLES) + ROLES.index(role)) * REGISTERS} float32",
    bare=bare.modbus,
)
OPCUA = Bus(
    key="opcua",
    name="OPC UA, subscriptions",
    serve=_opcua,
    connection=lambda port: {"kind": "opcua", "url": f"opc.tcp://127.0.0.1:{port}", "timeout": PATIENT},
    cell=lambda _, loop, role: node(loop, role),
    bare=bare.opcua,
)

BUSES = (MQTT, MODBUS, OPCUA)
