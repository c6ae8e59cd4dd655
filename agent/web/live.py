"""What changes, for pages that stay open: one stream for each page, and never more in memory than its queue.

A page has a view: named parts, each a JSON value. At each look at the plant, the parts that differ from
what was queued last are queued. A page that does not read fills its queue; then the queue is dropped, and the
next thing the page gets is its full state again.
"""

from __future__ import annotations

import asyncio
import json
import time
from collections import deque
from collections.abc import Awaitable, Callable, Mapping
from typing import Generic, NoReturn, TypeVar

from agent.runtime.operate.breath import breathing
from agent.runtime.supervisor import MARGIN, Health

QUEUE = 16
"""Changes that may wait for a page."""
PERIOD = 1.0
"""Shortest time from one look to the next, s."""
SHARE = 0.01
"""Largest part of the event loop's time that looking may take; more loops are looked at less often. Five open
pages are to add less than 5 % to an agent that needs 0.16 cores for 5,000 loops."""
MOST_PAGES = 64
"""Open streams; more are refused."""
Parts = Mapping[str, object]
S = TypeVar("S")


class Page(Generic[S]):
    """One open page: its view and what waits for it."""

    def __init__(self, view: Callable[[S], Parts | Awaitable[Parts]], limit: int = QUEUE) -> None:
        """Make it.

        Args:
            view: Parts of the page, each a JSON value, out of what a look at the plant gave; awaitable where
                they take long.
            limit: Changes that may wait.
        """
        self._view = view
        self._limit = limit
        self._known: dict[str, str] = {}
        self._waiting: deque[str] = deque()
        self._full = True
        self._filled = asyncio.Event()
        self._seeing = asyncio.Lock()
        self.ended = False
        """Whether nothing comes any more."""

    def __len__(self) -> int:
        """Changes that wait."""
        return len(self._waiting)

    async def see(self, look: S) -> None:
        """Queue what changed, one look after the other."""
        async with self._seeing:
            seen = self._view(look)
            self.offer(seen if isinstance(seen, Mapping) else await seen)

    def offer(self, seen: Parts) -> None:
        """Queue which parts changed; a queue that is full is dropped for the full state."""
        if len(self._waiting) >= self._limit:
            self._waiting.clear()
            self._known.clear()
            self._full = True
        parts = {name: json.dumps(part, separators=(",", ":")) for name, part in seen.items()}
        changed = {name: text for name, text in parts.items() if self._known.get(name) != text}
        changed |= dict.fromkeys(self._known.keys() - parts.keys(), "null")
        self._known = parts
        if changed or self._full:
            texts = ",".join(f"{json.dumps(name)}:{text}" for name, text in changed.items())
            self._waiting.append(f'{{"full":{"true" if self._full else "false"},"parts":{{{texts}}}}}')
            self._full = False
            self._filled.set()

    def end(self) -> None:
        """Say that nothing comes any more."""
        self.ended = True
        self._filled.set()

    async def next(self) -> str | None:
        """Return the next change as JSON text, when there is one; None at the end."""
        while not self._waiting:
            if self.ended:
                return None
            self._filled.clear()
            await self._filled.wait()
        return self._waiting.popleft()


class Live(Generic[S]):
    """Looks at the plant while pages are open. ``run`` is for a supervisor."""

    def __init__(self, look: Callable[[], Awaitable[S]], period: float = PERIOD) -> None:
        """Make it.

        Args:
            look: Gives what all views are made from.
            period: Shortest time from one look to the next, s.
        """
        self.health = Health("page")
        self.pages: set[Page[S]] = set()
        """Those that are open."""
        self._look = look
        self._period = period
        self._opened = asyncio.Event()
        self._newest: S | None = None
        self._looked = 0.0
        """When ``_newest`` was made, monotonic, s."""

    async def open(self, view: Callable[[S], Parts | Awaitable[Parts]]) -> Page[S] | None:
        """Return a new page that has its full state already; None where there are too many."""
        if len(self.pages) >= MOST_PAGES:
            return None
        page = Page(view)
        self.pages.add(page)
        await page.see(await self._recent())
        self._opened.set()
        return page

    def close(self, page: Page[S]) -> None:
        """Forget a page."""
        self.pages.discard(page)

    async def run(self) -> NoReturn:
        """Look again and again while any page is open, until cancelled; then end all pages."""
        try:
            while True:
                self.health.expect("look", None)
                await self._opened.wait()
                if not self.pages:
                    self._opened.clear()
                    continue
                self.health.expect("look", MARGIN)
                began = time.perf_counter()
                await self.tick()
                await asyncio.sleep(max(self._period, (time.perf_counter() - began) / SHARE))
        finally:
            for page in self.pages:
                page.end()

    async def tick(self) -> None:
        """Look once, for all pages."""
        look = self._newest = await self._look()
        self._looked = time.monotonic()
        async for page in breathing(list(self.pages)):
            await page.see(look)

    async def _recent(self) -> S:
        """Return a look that is younger than the shortest period: pages that open together share it."""
        if self._newest is None or time.monotonic() - self._looked >= self._period:
            self._newest, self._looked = await self._look(), time.monotonic()
        return self._newest
