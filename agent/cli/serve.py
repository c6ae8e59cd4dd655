"""``slipjump serve``: simulated loops on a real server, to train people and to test what reads them."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import time
from collections.abc import Coroutine, Mapping, Sequence
from contextlib import AsyncExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from agent.cli.common.columns import aligned
from agent.cli.common.errors import BAD_INPUT, complain
from agent.cli.common.recordings import Bus

if TYPE_CHECKING:
    from simulators.scenario import Scenario
    from simulators.servers.loop_server import LoopServer


PACES = ("poll", "publishing_interval")
"""Options of a connection that are times between two readings, s."""
PORTS = {Bus.OPCUA: 4840, Bus.MODBUS: 1502, Bus.MQTT: 1883}
"""Tried first where no port is given; another that is free is taken where they are in use."""


def serve(
    scenarios: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENARIO...", help="Files, or names of `serve --list`.", show_default=False),
    ] = None,
    *,
    bus: Annotated[Bus, typer.Option(help="Bus on which they are served.")] = Bus.OPCUA,
    speed: Annotated[
        float, typer.Option(min=0.01, max=1000, metavar="X", help="Times real time; source times run along.")
    ] = 1.0,
    host: Annotated[str, typer.Option(help="Address to listen on. Nothing is encrypted.")] = "127.0.0.1",
    port: Annotated[
        int | None, typer.Option(min=1, max=65535, help="Port; default: that of the bus, or a free one.")
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(min=0.1, help="Stop after so many seconds; default: at Ctrl-C.")
    ] = None,
    config: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.yaml", help="Write a configuration with which `slipjump run` watches them."
        ),
    ] = None,
    list_them: Annotated[
        bool, typer.Option("--list", help="Print the scenarios that ship, and end.")
    ] = False,
) -> None:
    """Serve simulated loops on OPC UA, Modbus or MQTT, for training and acceptance tests.

    Each loop has OP, PV, SP and the valve position; alarms may be written back. What is hidden in the
    scenarios that ship is in a file that --list names.
    """
    if list_them:
        _print_list()
        return
    if not scenarios:
        raise typer.BadParameter("name at least one; `slipjump serve --list` prints those that ship")
    loops = _loaded(scenarios)
    try:
        asyncio.run(_serve(loops, bus, speed, host, port, seconds, config))
    except OSError as error:
        complain(str(error) if error.filename is None else f"{error.filename}: {error.strerror}")
        raise typer.Exit(BAD_INPUT) from error


def _loaded(names: Sequence[str]) -> list[Scenario]:
    """Return the scenarios; refuses unknown names and two loops of one name, all at once."""
    from agent.cli.common.config_folder import config_folder
    from connectors.base import ConfigError
    from simulators.hidden_faults import scenario_path
    from simulators.scenario import load_scenario

    found, faults = [], []
    for name in names:
        path = scenario_path(name, config_folder() / "scenarios")
        if not path.exists():
            faults.append(f"{name}: no such file, and no scenario of `slipjump serve --list`")
            continue
        try:
            found.append(load_scenario(path))
        except ConfigError as error:
            faults += error.faults
    loops = [each.loop for each in found]
    faults += [
        f"{loop}: {loops.count(loop)} scenarios are called so"
        for loop in dict.fromkeys(loops)
        if loops.count(loop) > 1
    ]
    if faults:
        raise ConfigError(faults)
    return found


async def _serve(
    loops: Sequence[Scenario],
    bus: Bus,
    speed: float,
    host: str,
    port: int | None,
    seconds: float | None,
    config: Path | None,
) -> None:
    from simulators.clock import Clock
    from simulators.player import play
    from simulators.servers.loop_server import roles_of
    from simulators.source import EndlessSource

    start = time.time()
    sources = [EndlessSource(each, start) for each in loops]
    async with AsyncExitStack() as stack:
        server = await _server(bus, roles_of(sources), host, port, stack)
        connection = _gentle(server.connection_settings(), 0.5 * min(each.ts for each in loops) / speed)
        entries = [_entry(server, scenario) for scenario in loops]
        if config is not None:
            clock = {} if speed == 1 else {"agent": {"clock_error": None}}  # source times run faster
            _write(config, {**clock, "connections": {server.name: connection}, "loops": entries})
        address = connection.get("url") or f"{bus}://{connection['host']}:{connection['port']}"
        typer.echo(f"address: {address}/")
        for line in _tags(entries):
            typer.echo(line)
        if config is not None:
            typer.echo(f"watch them: slipjump run {config}")
        await _until_stopped(play(sources, server, Clock(speed)), seconds)


async def _until_stopped(playing: Coroutine[Any, Any, None], seconds: float | None) -> None:
    """Play until Ctrl-C or SIGTERM, or for so long, s."""
    stop, loop = asyncio.Event(), asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        with contextlib.suppress(NotImplementedError):  # Windows: Ctrl-C ends the program all the same
            loop.add_signal_handler(number, stop.set)
    work = {asyncio.create_task(playing, name="players"), asyncio.create_task(stop.wait(), name="signals")}
    done, waiting = await asyncio.wait(work, timeout=seconds, return_when=asyncio.FIRST_COMPLETED)
    for task in waiting:
        task.cancel()
    await asyncio.wait(work)
    for task in done:
        task.result()


async def _server(
    bus: Bus, roles: Mapping[str, Sequence[str]], host: str, port: int | None, stack: AsyncExitStack
) -> LoopServer:
    """Start the server on the given port, else on the usual one, else on any."""
    from simulators.servers.broker import embedded_broker
    from simulators.servers.modbus import ModbusServer
    from simulators.servers.mqtt import MqttServer
    from simulators.servers.opcua import OpcUaServer

    for number in (PORTS[bus], 0) if port is None else (port,):
        try:
            if bus is Bus.MODBUS:
                return await stack.enter_async_context(ModbusServer(roles, host, number))
            if bus is Bus.OPCUA:
                return await stack.enter_async_context(OpcUaServer(roles, host, number))
            broker = await stack.enter_async_context(embedded_broker(host, number))
            return await stack.enter_async_context(MqttServer(roles, host, broker))
        except OSError:
            if number in (port, 0):
                raise
    raise AssertionError


def _entry(server: LoopServer, scenario: Scenario) -> dict[str, Any]:
    """Return the loop as a configuration has it, with what its engineer would know."""
    return {
        **server.loop_settings(scenario.loop, scenario.ts),
        "acting": scenario.controller.acting,
        "op_range": list(scenario.op_range),
    }


def _gentle(connection: Mapping[str, Any], interval: float) -> dict[str, Any]:
    """Return a connection that reads no more often than it needs; the servers' own are for tests."""
    paces = {key: max(value, interval) for key, value in connection.items() if key in PACES}
    return {**connection, **paces}


def _tags(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a table of the addresses, a row a loop."""
    roles = list(dict.fromkeys(role for entry in entries for role in entry["tags"]))
    rows = [[entry["name"], *(_address(entry["tags"].get(role, {})) for role in roles)] for entry in entries]
    return aligned([["LOOP", *(role.upper() for role in roles)], *rows])


def _address(tag: Mapping[str, Any]) -> str:
    """Return where a value is, e.g. ``ns=2;s=FIC101.PV``, ``input 0`` or ``plant/FIC101 pv``."""
    keys = ("node", "table", "address", "topic", "field")
    return " ".join(str(tag[key]) for key in keys if key in tag)


def _write(path: Path, content: Mapping[str, Any]) -> None:
    import yaml

    text = yaml.safe_dump(dict(content), sort_keys=False, default_flow_style=None, width=110)
    path.write_text(f"# Loops of `slipjump serve`: slipjump run {path.name}\n{text}", encoding="utf-8")


def _print_list() -> None:
    """Print the scenarios that ship, without what is hidden in them."""
    from agent.cli.common.config_folder import config_folder
    from simulators.hidden_faults import TRUTH, shipped
    from simulators.scenario import load_scenario

    folder = config_folder() / "scenarios"
    rows = [["SCENARIO", "LOOP", "TS", "LASTS"]]
    for name, path in shipped(folder).items():
        scenario = load_scenario(path)
        ends = scenario.set_points or scenario.load_steps or scenario.gain_steps
        lasts = f"{scenario.duration:g} s, then anew" if ends else "goes on"
        rows.append([name, scenario.loop, f"{scenario.ts:g} s", lasts])
    for line in (*aligned(rows), f"what is hidden in them: {folder / TRUTH}"):
        typer.echo(line)
