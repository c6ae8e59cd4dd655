"""The page of a plant of 5,000 loops: its first view, and what five open pages cost the agent."""

from __future__ import annotations

import asyncio
import functools
import re
import subprocess
import time
import urllib.request
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from agent.cli.common.page import free_port, serve_page
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import (
    AgentSettings,
    ConnectionSettings,
    HttpSettings,
    LoopSettings,
    Settings,
    WindowSettings,
)
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from connectors.base import LoopRole, Publication, Quality, Sample
from connectors.options import Options as TagOptions

LOOPS = 5000
PAGES = 5
SECONDS = 20.0
"""Of each of the two stretches that are compared."""
ROUNDS = 3
"""Stretches without and with pages in turn, so that a busy machine disturbs both."""
ENTRY = ("/", "/api/session", "/api/work-list")


class Source:
    """A bus in memory: each loop's OP and PV once a second."""

    name = "bus"
    takes_orders = False

    def __init__(self, loops: list[str]) -> None:
        self._loops = loops
        self.sent = 0

    @asynccontextmanager
    async def session(self) -> AsyncIterator[Source]:
        """Open it."""
        yield self

    async def samples(self) -> AsyncIterator[Sample]:
        """Yield samples for ever, spread over each second."""
        began = time.time()
        second = 0
        while True:
            for at, loop in enumerate(self._loops):
                for role, value in (("op", 50 + second % 7), ("pv", 20 + second % 5)):
                    yield Sample(LoopRole(loop, role), began + second, float(value), Quality.GOOD)
                    self.sent += 1
                if at % 250 == 0:
                    await asyncio.sleep(max(0.0, began + second + at / len(self._loops) - time.time()))
            second += 1

    async def publish(self, publication: Publication) -> None:
        """Take it."""


def run(options: Options) -> None:
    """Print time and bytes of the first view, and the agent's CPU with and without pages."""
    del options
    asyncio.run(_measured())


async def _measured() -> None:
    names = [f"{k // 100:02d}-FIC-{k:04d}" for k in range(LOOPS)]
    loops = tuple(
        LoopSettings(
            name=name,
            connection="bus",
            ts=1.0,
            tags={"op": TagOptions(), "pv": TagOptions()},
            window=WindowSettings(seconds=600.0),
        )
        for name in names
    )
    source = Source(names)
    settings = Settings(AgentSettings(), {"bus": ConnectionSettings("fake", TagOptions())}, loops)
    agent = Agent(settings, InlineExecutor(), connectors=[source])
    ready = asyncio.Event()
    port = free_port(0)
    serve_page(agent, HttpSettings(port=port), lambda _: ready.set())
    work = asyncio.create_task(agent.run())
    try:
        await ready.wait()
        await asyncio.sleep(5.0)
        address = f"http://127.0.0.1:{port}"
        views = [await asyncio.to_thread(functools.partial(_first_view, address)) for _ in range(3)]
        seconds, size, requests = min(views)
        without, with_pages, lost = [], [], 0
        for _ in range(ROUNDS):
            without.append(await _cpu())
            pages = [_opened(address) for _ in range(PAGES)]
            await asyncio.sleep(2.0)
            with_pages.append(await _cpu())
            for page in pages:
                page.kill()
                page.wait()
            status = await agent.looked()
            lost = sum(each.bad for each in status.loops)
        received = sum(each.samples for each in (await agent.looked()).loops)
    finally:
        work.cancel()
        await asyncio.wait({work})
    first = (f"{LOOPS}", f"{seconds:.2f}", f"{size / 1000:.0f}", f"{requests}")
    print(table("### First view", ("loops", "s", "kB transferred", "requests"), [first]))
    a, b = sorted(without)[ROUNDS // 2], sorted(with_pages)[ROUNDS // 2]
    share = (
        f"{a:.3f}",
        f"{b:.3f}",
        f"{100 * (b - a):+.1f}",
        f"{100 * (b / a - 1):+.1f} %",
        f"{source.sent - received}",
        f"{lost}",
    )
    heads = (
        "cores without pages",
        f"with {PAGES} pages",
        "more, % of a core",
        "more, of the agent's",
        "samples lost",
        "bad",
    )
    print(table("### CPU of the agent", heads, [share]))


async def _cpu() -> float:
    """Return how many cores this process uses over a stretch."""
    began, spent = time.perf_counter(), time.process_time()
    await asyncio.sleep(SECONDS)
    return (time.process_time() - spent) / (time.perf_counter() - began)


def _opened(address: str) -> subprocess.Popen[bytes]:
    """Open the stream of the work list as a page does."""
    words = ["curl", "-sN", "--compressed", f"{address}/api/work-list/stream"]
    return subprocess.Popen(words, stdout=subprocess.DEVNULL)  # noqa: S603 - our own command


def _first_view(address: str) -> tuple[float, int, int]:
    """Return seconds, bytes and requests of what a browser loads for the first screen, in a row."""
    began, size, seen = time.perf_counter(), 0, set[str]()
    waiting = [*ENTRY, "/static/screens/work_list.js"]
    while waiting:
        path = waiting.pop()
        if path in seen:
            continue
        seen.add(path)
        request = urllib.request.Request(f"{address}{path}", headers={"Accept-Encoding": "gzip"})  # noqa: S310
        with urllib.request.urlopen(request) as answer:  # noqa: S310 - our own address
            content = answer.read()
            zipped = answer.headers.get("Content-Encoding") == "gzip"
        size += len(content)
        if path == "/" or path.endswith((".js", ".mjs")):
            waiting += _named(content, path, zipped=zipped)
    return time.perf_counter() - began, size, len(seen)


def _named(content: bytes, path: str, *, zipped: bool) -> list[str]:
    """Return the files that a file loads at once."""
    import gzip  # noqa: PLC0415

    text = (gzip.decompress(content) if zipped else content).decode()
    found = re.findall(r'(?:src|href)="(/static/[^"]+)"', text)
    folder = path.rpartition("/")[0]
    for name in re.findall(r'from "(\.[^"]+)"', text):
        parts = f"{folder}/{name}".split("/")
        kept: list[str] = []
        for part in parts:
            if part == "..":
                kept.pop()
            elif part != ".":
                kept.append(part)
        found.append("/".join(kept))
    return found
