"""Tools of the checks: a connector for a peer, a reader that keeps samples, conditions with a deadline."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any, Self

from connectors.base import (
    ConnectionLostError,
    Connector,
    JsonValue,
    LoopRole,
    Order,
    Publication,
    Sample,
    Session,
)
from connectors.checks.peer import LOOPS, Peer
from connectors.kind import ConnectorKind
from connectors.options import LoopTags

Kind = ConnectorKind[Any, Any, Any]
DEADLINE = 30.0
"""Longest time for anything that must happen, s: test machines are slow."""
PROMPT = 5.0
"""Longest time to obey a cancellation, s."""


def connector_to(kind: Kind, peer: Peer, port: int | None = None, *, wait: float = 1.0) -> Connector:
    """Return a connector of ``kind`` to a peer, made from entries as the configuration file has them."""
    loops = {}
    for name in LOOPS:
        entry = peer.loop(name)
        loops[name] = LoopTags(
            {role: kind.tag.model_validate(tag) for role, tag in entry["tags"].items()},
            [kind.target.model_validate({"connection": "check", **target}) for target in entry["publish"]],
        )
    return kind.open("check", kind.options.model_validate(peer.connection(port, wait=wait)), loops)


class Reader:
    """Reads a session in a task of its own and keeps what it yields."""

    def __init__(self, session: Session) -> None:
        self.samples: list[Sample] = []
        self.orders: list[Order] = []
        self._session = session
        self._newest: dict[str, float] = {}
        self._ended = False

    def seen(self, loop: str) -> float | None:
        """Return the time of the newest sample of a loop, s UTC."""
        return self._newest.get(loop)

    def of(self, tag: LoopRole) -> list[Sample]:
        """Return the samples of a tag in their order."""
        return [sample for sample in self.samples if sample.tag == tag]

    async def __aenter__(self) -> Self:
        """Begin to read."""
        self._task = asyncio.create_task(self._run(), name="reader of a check")
        return self

    @property
    def task(self) -> asyncio.Task[None]:
        """The task that reads."""
        return self._task

    async def __aexit__(self, *_: object) -> None:
        """Stop reading; raises what ended the reading before."""
        if self._ended:
            return
        self._task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await self._task

    async def end(self, within: float) -> None:
        """Wait until the reading ends by itself and raise what it raised; raises TimeoutError."""
        async with asyncio.timeout(within):
            await asyncio.wait([self._task])
        self._ended = True
        self._task.result()

    async def _run(self) -> None:
        async with contextlib.aclosing(self._session.samples()) as samples:  # type: ignore[type-var]
            async for sample in samples:
                if isinstance(sample, Order):
                    self.orders.append(sample)
                    continue
                self.samples.append(sample)
                self._newest[sample.tag.loop] = sample.time


async def until(condition: Callable[[], object], within: float = DEADLINE) -> None:
    """Wait for a condition; raises TimeoutError."""
    async with asyncio.timeout(within):
        while not condition():  # noqa: ASYNC110 - the peer makes it true, and has no event for it
            await asyncio.sleep(0.002)


async def expect(
    condition: Callable[[], object], failure: str | Callable[[], str], within: float = DEADLINE
) -> None:
    """Wait for a condition; raises AssertionError with the text ``failure``."""
    try:
        await until(condition, within)
    except TimeoutError:
        raise AssertionError(failure if isinstance(failure, str) else failure()) from None


def require(condition: object, failure: str) -> None:
    """Raise AssertionError with the text ``failure`` unless the condition holds."""
    if not condition:
        raise AssertionError(failure)


async def expect_loss(what: str, work: Awaitable[object], within: float = DEADLINE) -> None:
    """Require that ``work`` raises ConnectionLostError in time; any other exception is passed on."""
    try:
        async with asyncio.timeout(within):
            await work
    except ConnectionLostError as error:
        require(str(error), f"{what}: ConnectionLostError has no text; it must say what is lost")
        return
    except TimeoutError:
        raise AssertionError(f"{what}: no ConnectionLostError within {within:g} s") from None
    raise AssertionError(f"{what}: expected ConnectionLostError, nothing was raised")


async def enter(connector: Connector) -> None:
    """Open a session and close it."""
    async with connector.session():
        pass


async def open_and_read(connector: Connector) -> None:
    """Open a session and read it until it ends."""
    async with connector.session() as session:
        async for _ in session.samples():
            pass


def alarm(loop: str, *, active: bool, time: float = 1.7e9) -> Publication:
    """Return a state of a loop's alarm with every field that the agent publishes."""
    state = "unacked_active" if active else "normal"
    fields: dict[str, JsonValue] = {
        "message_id": f"{loop}/{state}",
        "schema": 1,
        "sequence": 1,
        "historical": False,
        "loop": loop,
        "id": f"{loop}/1",
        "active": active,
        "state": state,
        "verdict": "stiction" if active else "no_stiction",
        "priority": "high",
        "ne107": "maintenance_required" if active else "normal",
        "health": 4 if active else 0,
        "time": time,
        "by": None,
        "until": None,
        "f_s": 2.5,
        "f_d": 1.5,
        "s": 4.0,
        "j": None,
    }
    return Publication(loop, "state", str(fields["message_id"]), fields)


@asynccontextmanager
async def no_escaped_exception() -> AsyncIterator[None]:
    """Require that no task or callback ends with an exception that nobody handles."""
    import gc  # noqa: PLC0415 - here only

    loop = asyncio.get_running_loop()
    escaped: list[dict[str, Any]] = []
    former = loop.get_exception_handler()
    loop.set_exception_handler(lambda _, context: escaped.append(context))
    try:
        yield
        gc.collect()  # exceptions of tasks that nobody awaits are reported when the task is collected
    finally:
        loop.set_exception_handler(former)
    texts = [str(context.get("exception") or context["message"]) for context in escaped]
    require(not texts, f"exceptions that nobody handles: {'; '.join(texts)}")
