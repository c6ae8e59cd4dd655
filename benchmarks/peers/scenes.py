"""One scene a peer: an agent is pointed at it, and what must hold is waited for, with a deadline."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from typing import Any, Self

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.operate.status import LoopStatus
from agent.settings import settings_of
from connectors.modbus.client import connected
from connectors.modbus.options import ModbusOptions
from tests.unit.runtime.agents import judged

DEADLINE = 60.0
"""s; a busy machine takes its time."""
MOST_REQUESTS = 6
"""For 60 loops side by side and one that is not there: one, two or three in vain, and ours."""
Step = tuple[str, float]
"""What held, and after how many seconds."""


class Process:
    """A peer: it says a JSON object a line, the first with its port."""

    def __init__(self, command: Sequence[str]) -> None:
        self._command = command
        self.said: list[dict[str, Any]] = []

    async def __aenter__(self) -> Self:
        """Start it, and return when it says where it listens."""
        pipe = asyncio.subprocess.PIPE
        self._process = await asyncio.create_subprocess_exec(*self._command, stdin=pipe, stdout=pipe)
        self._reading = asyncio.create_task(self._read())
        await until(lambda: bool(self.said) or self._reading.done())
        return self

    async def __aexit__(self, *_: object) -> None:
        """End it."""
        with contextlib.suppress(ProcessLookupError):
            self._process.kill()
        await self._process.wait()
        await self._reading

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self.said[0]["port"])

    async def obey(self) -> None:
        """Have it do the one thing that it can be told to do."""
        if self._process.stdin is not None:
            self._process.stdin.write(b"\n")
            await self._process.stdin.drain()

    async def _read(self) -> None:
        if self._process.stdout is not None:
            async for line in self._process.stdout:
                if line.startswith(b"{"):  # its libraries print warnings of their own
                    self.said.append(json.loads(line))


def _hold(what: str, holds: bool) -> None:  # noqa: FBT001 - the condition itself
    if not holds:
        raise RuntimeError(f"does not hold: {what}")


async def until(condition: Callable[[], bool]) -> float:
    """Return after how many seconds it holds; raises TimeoutError."""
    clock = asyncio.get_running_loop()
    began = clock.time()
    async with asyncio.timeout(DEADLINE):
        while not condition():  # noqa: ASYNC110 - nobody reports it
            await asyncio.sleep(0.05)
    return clock.time() - began


async def aedes(command: Sequence[str]) -> AsyncIterator[Step]:
    """A broker that hangs up on a refused topic, and forgets all when it is started anew."""
    tags = {role: {"topic": "plant/{loop}", "field": role, "time_field": "t"} for role in ("pv", "op")}
    async with Process(command) as peer, _agent(peer.port, "mqtt", ["FIC101", "FIC102"], tags) as agent:

        def published(loop: str, start: int = 0) -> bool:
            return any(each.get("topic") == f"slipjump/{loop}/alarm" for each in peer.said[start:])

        yield (
            "a refused topic ends the session; the other loop is published",
            await until(lambda: published("FIC102")),
        )
        yield (
            "the refused topic is set aside, and the reason stated",
            await until(lambda: "ends the connection" in " ".join(agent.outboxes["peer"].refusals.reasons)),
        )
        yield (
            "both loops have data",
            await until(lambda: all(each.data == "fresh" for each in agent.status())),
        )
        start = len(peer.said)
        await peer.obey()
        yield (
            "started anew without anything kept: the state is published again",
            await until(
                lambda: any(each.get("again") for each in peer.said[start:]) and published("FIC102", start)
            ),
        )
        _hold("nothing refused was published", not published("FIC101"))


async def node_opcua(command: Sequence[str]) -> AsyncIterator[Step]:
    """A server on which one node is missing."""
    async with Process(command) as peer:
        space = peer.said[0]["namespace"]
        tags = {role: {"node": f"ns={space};s={{loop}}.{role.upper()}"} for role in ("pv", "op")}
        async with _agent(peer.port, "opcua", ["FIC101", "FIC102"], tags) as agent:
            yield "a loop is judged", await until(lambda: _of(agent, "FIC101").diagnosis is not None)
            yield (
                "a loop without its PV node is stale, and the reason stated",
                await until(
                    lambda: _of(agent, "FIC102").data == "stale" and "PV" in _of(agent, "FIC102").problem
                ),
            )
            _hold("the other loop goes on", _of(agent, "FIC101").data == "fresh")


async def libmodbus(command: Sequence[str]) -> AsyncIterator[Step]:
    """A device with 60 loops side by side, and one at addresses that it does not have."""
    names = [f"L{k:02d}" for k in range(60)]
    async with Process(command) as peer:
        tags = {
            name: {
                role: {"table": "input", "address": 2 * k + (role == "op"), "type": "uint16"}
                for role in ("pv", "op")
            }
            for k, name in enumerate(names)
        }
        tags["gone"] = {role: {"table": "input", "address": 5000 + k} for k, role in enumerate(("pv", "op"))}
        async with _agent(peer.port, "modbus", tags, tags, poll=0.05) as agent:
            yield (
                "60 loops are judged",
                await until(lambda: all(_of(agent, name).diagnosis is not None for name in names)),
            )
            yield (
                "a loop at addresses that are not there is stale, and the reason stated",
                await until(
                    lambda: _of(agent, "gone").data == "stale" and "exception 2" in _of(agent, "gone").problem
                ),
            )
            samples, requests = _of(agent, "L59").samples, await _requests(peer.port)
            await until(lambda: _of(agent, "L59").samples >= samples + 100)
            polls = (_of(agent, "L59").samples - samples) / 2
            each = (await _requests(peer.port) - requests) % 65536 / polls
            yield f"{each:.1f} requests read 61 loops", 0.0
            _hold("neighbours share requests", each < MOST_REQUESTS)


async def _requests(port: int) -> int:
    async with connected(ModbusOptions(port=port)) as client:
        return (await client.read("input", 120, 1))[0]


def _of(agent: Agent, loop: str) -> LoopStatus:
    return next(each for each in agent.status() if each.loop == loop)


@asynccontextmanager
async def _agent(
    port: int,
    kind: str,
    loops: Sequence[str] | Mapping[str, Any],
    tags: Mapping[str, Any],
    **options: Any,  # noqa: ANN401
) -> AsyncIterator[Agent]:
    """Run an agent beside a peer; it finds every valve sticking, so that there is something to publish."""
    place = {"url": f"opc.tcp://127.0.0.1:{port}"} if kind == "opcua" else {"port": port}
    entries = [
        {
            "name": name,
            "connection": "peer",
            "ts": 0.1,
            "tags": _filled(tags.get(name, tags), name),
            "window": {"seconds": 3.0, "hop": 0.5},
            "alarm": {"on_delay": 1},
            "quantify": "always",
            **({"publish": [{"connection": "peer"}]} if kind == "mqtt" else {}),
        }
        for name in loops
    ]
    raw = {
        "agent": {"data_age": 5.0},
        "connections": {"peer": {"kind": kind, **place, **options}},
        "loops": entries,
    }
    agent = Agent(settings_of(raw), InlineExecutor(), diagnose=judged())
    task = asyncio.create_task(agent.run())
    try:
        yield agent
    finally:
        task.cancel()
        await asyncio.wait({task})
        if not task.cancelled():
            task.result()


def _filled(tags: Any, loop: str) -> Any:  # noqa: ANN401 - as JSON is
    """Put the name of the loop where the tags have ``{loop}``."""
    return json.loads(json.dumps(tags).replace("{loop}", loop))
