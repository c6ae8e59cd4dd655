"""Sessions of the workbench, each a process of its own: bounded in number, ended when nobody uses them."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import secrets
import shutil
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from agent.runtime.loop.process_pool import CONTEXT
from agent.web.live import Page, Parts
from agent.web.workbench.desk import Opening, work

MOST = 4
"""Sessions at a time: each holds some 300 MB."""
IDLE = 30 * 60.0
"""Time after which a session that nobody uses ends, s."""
CHECKED = 20.0
"""Time between two looks at who is idle, s."""
PATIENCE = 600.0
"""Longest time that one command may take, s."""


class WorkbenchError(Exception):
    """A command could not be done; the text is for the user."""


@dataclass(frozen=True, slots=True)
class SessionLook:
    """What open pages of a session get."""

    version: int
    busy: bool
    progress: dict[str, Any] | None
    curve: dict[str, Any] | None
    """A first curve of the model that is being fitted."""
    fault: str | None
    """Why the newest command was not done."""
    ended: bool


class WorkbenchSession:
    """One session and its process."""

    def __init__(self, name: str, folder: Path, clock: Callable[[], float]) -> None:
        """Start the process.

        Args:
            name: Its address.
            folder: Of its files; it goes with the session.
            clock: Monotonic time, s.
        """
        self.name, self.folder, self._clock = name, folder, clock
        self.used = clock()
        self.state: dict[str, Any] | None = None
        """Newest state for the page; None before the first."""
        self.names: list[str] = []
        """Columns of a recording whose roles were not recognised."""
        self.first = asyncio.Event()
        """Set when there is a state."""
        self.source: Opening | None = None
        """Recording that was opened; None before."""
        self.opening: asyncio.Task[Any] | None = None
        self.pages: set[Page[SessionLook]] = set()
        self._look = SessionLook(0, busy=False, progress=None, curve=None, fault=None, ended=False)
        self._numbers = itertools.count()
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._one = asyncio.Lock()
        self._loop = asyncio.get_running_loop()
        self._pipe, other = CONTEXT.Pipe()
        self._process = CONTEXT.Process(target=work, args=(other,), name=f"workbench {name}")
        self._process.start()
        other.close()
        threading.Thread(target=self._listen, name=f"workbench {name}", daemon=True).start()

    @property
    def ended(self) -> bool:
        """Whether its process is gone."""
        return self._look.ended

    def page(self) -> Page[SessionLook]:
        """Return a new stream, with its full state already."""
        page: Page[SessionLook] = Page(_parts)
        page.offer(_parts(self._look))
        self.pages.add(page)
        return page

    async def command(self, name: str, *arguments: object, quiet: bool = False) -> Any:  # noqa: ANN401 - JSON
        """Have a command of ``Desk`` done and return its answer.

        Args:
            name: Of the method.
            arguments: Its arguments.
            quiet: It changes nothing, so that pages are not informed.

        Raises:
            WorkbenchError: It cannot be done, or the process died.
        """
        self.used = self._clock()
        async with self._one:
            if self._look.ended:
                raise WorkbenchError("this session has ended; open the recording again")
            number = next(self._numbers)
            future = self._waiting[number] = self._loop.create_future()
            if not quiet:
                self._publish(busy=True, progress=None, curve=None, fault=None)
            fault: str | None = None
            try:
                self._pipe.send((number, name, arguments))
                answer, fault = await asyncio.wait_for(future, PATIENCE)
            except (OSError, TimeoutError) as error:
                self.end()
                raise WorkbenchError(
                    "the process of this session has ended; open the recording again"
                ) from error
            finally:
                self._waiting.pop(number, None)
                self.used = self._clock()
                if not quiet:
                    self._publish(busy=False, progress=None, curve=None, fault=fault)
            if fault is not None:
                raise WorkbenchError(fault)
            return answer

    def end(self) -> None:
        """End the process and all pages."""
        if self.opening is not None:
            self.opening.cancel()
        self._publish(busy=False, ended=True)
        for page in self.pages:
            page.end()
        for future in self._waiting.values():
            if not future.done():
                future.set_exception(OSError("ended"))
        with contextlib.suppress(OSError):
            self._pipe.close()
        self._process.terminate()
        shutil.rmtree(self.folder, ignore_errors=True)

    def _listen(self) -> None:
        """Take messages in a thread of its own until the process ends."""
        while True:
            try:
                message = self._pipe.recv()
            except (EOFError, OSError):
                break
            with contextlib.suppress(RuntimeError):  # the event loop is gone
                self._loop.call_soon_threadsafe(self._received, *message)
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._gone)

    def _received(self, kind: str, content: Any) -> None:  # noqa: ANN401 - JSON
        match kind:
            case "state":
                self.state = content
                self.first.set()
                self._publish(version=self._look.version + 1, curve=None)
            case "done":
                number, answer, fault = content
                future = self._waiting.get(number)
                if future is not None and not future.done():
                    future.set_result((answer, fault))
            case "names":
                self.names = content
            case "progress":
                self._publish(progress=content)
            case _:
                self._publish(curve=content)

    def _gone(self) -> None:
        if not self._look.ended:
            self.end()

    def _publish(self, **changed: Any) -> None:  # noqa: ANN401 - fields of ``SessionLook``
        known = {name: getattr(self._look, name) for name in SessionLook.__slots__}
        self._look = SessionLook(**{**known, **changed})
        for page in self.pages:
            page.offer(_parts(self._look))


class Sessions:
    """All sessions of one server. ``run`` is for a supervisor."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Begin without any."""
        self._clock = clock
        self.open: dict[str, WorkbenchSession] = {}

    def create(self, name: str | None = None) -> WorkbenchSession:
        """Return a new session, with a folder for its files; those that ended by themselves make room.

        Raises:
            WorkbenchError: Too many are open.
        """
        for each in [*self.open.values()]:
            if each.ended:
                self.end(each.name)
        idle = [each for each in self.open.values() if not each.pages]
        if len(self.open) >= MOST:
            if not idle:
                raise WorkbenchError(f"{MOST} sessions are open, no more are possible: end one of them")
            self.end(min(idle, key=lambda each: each.used).name)
        name = name or secrets.token_urlsafe(9)
        folder = Path(tempfile.mkdtemp(prefix="slipjump-workbench-"))
        session = self.open[name] = WorkbenchSession(name, folder, self._clock)
        return session

    def end(self, name: str) -> None:
        """End a session; nothing happens where there is none."""
        session = self.open.pop(name, None)
        if session is not None:
            session.end()

    def end_idle(self) -> None:
        """End the sessions that nobody uses."""
        for session in [*self.open.values()]:
            if not session.pages and self._clock() - session.used > IDLE:
                self.end(session.name)

    async def run(self) -> NoReturn:
        """Look after idle sessions until cancelled, then end all."""
        try:
            while True:
                await asyncio.sleep(CHECKED)
                self.end_idle()
        finally:
            for name in [*self.open]:
                self.end(name)


async def opened(sessions: Sessions, opening: Opening, session: WorkbenchSession) -> None:
    """Open a recording in a session and return when its first model is there; candidates follow.

    Raises:
        WorkbenchError: It cannot be read; the text says why. The session has ended then.
    """
    session.source = opening
    session.opening = asyncio.create_task(session.command("open", opening), name=f"open {session.name}")
    session.opening.add_done_callback(_seen)
    first = asyncio.create_task(session.first.wait(), name="first state")
    try:
        await asyncio.wait({session.opening, first}, return_when=asyncio.FIRST_COMPLETED)
        if session.state is None:
            try:
                await session.opening
            finally:
                sessions.end(session.name)
    finally:
        first.cancel()


def _seen(opening: asyncio.Task[Any]) -> None:
    """Take note of how an opening ended: pages were informed already."""
    if not opening.cancelled():
        opening.exception()


def _parts(look: SessionLook) -> Parts:
    return {name: getattr(look, name) for name in SessionLook.__slots__}
