"""One session in its own process: reads the recording, obeys commands, sends what the page shows."""

from __future__ import annotations

import contextlib
import math
import signal
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from agent.runtime.capabilities import cores, step_back
from agent.web.workbench.same_lines import ReadSource
from agent.web.workbench.view import axis_json, curve_json, tree_json
from connectors.base import ConfigError

NICE = 5
"""How much a session gives way to the diagnoses of an agent."""
MOST_NAMES = 200
"""Columns that a user chooses from."""
Send = Callable[[str, object], None]
"""Sends a kind of message and its content: ``progress``, ``curve``, ``state`` or ``names`` of columns."""


@dataclass(frozen=True, slots=True)
class Opening:
    """What a session begins with."""

    file: Path
    name: str
    """Of the recording, as its user knows it."""
    base: str = "fopdt"
    columns: Mapping[str, str] | None = None
    """Role (OP, PV, SP, time) -> column, where the user corrected what was recognised."""
    loop: str | None = None
    """Which loop of a file with several."""


class Desk:
    """Obeys commands, one after the other."""

    def __init__(self, send: Send) -> None:
        """Begin without a recording; ``send`` is called with each message."""
        self._send = send
        self._opening: Opening | None = None
        self._columns: dict[str, str] = {}
        self._tree: Any = None

    def open(self, opening: Opening, run: Any) -> None:  # noqa: ANN401 - ``Map``
        """Read a recording and fit the base, then try its candidates.

        Raises:
            ConfigError: The file cannot be read; each fault names what was expected.
            ValueError: There is no such base.
        """
        from agent.workbench.session.step_tree import StepTree  # noqa: PLC0415 - in the session's process only

        try:
            window, self._columns = _read(opening)
        except (ConfigError, ValueError):
            self._send("names", _names(opening))
            raise
        self._opening = opening
        self._tree = StepTree(window, opening.base, run, self._progress)
        self._settle()

    def tick(self, effect: str) -> None:
        """Add an effect; its curve comes at once where it was tried as a candidate."""
        quick = self._tree.quick(effect)
        if quick is not None:
            self._send("curve", {"effect": effect, "pv": curve_json(quick, len(quick))})
        self._tree.add(effect)
        self._settle()

    def untick(self, effect: str) -> None:
        """Take an effect out."""
        self._tree.drop(effect)
        self._settle()

    def go(self, number: int) -> None:
        """Look at another step."""
        self._tree.go(number)
        self._settle()

    def leave_out(self, start: float, end: float) -> None:
        """Fit everything again without a stretch, s from the start."""
        self._tree.leave_out((start, end))
        self._settle()

    def fit_from(self, values: Mapping[str, float]) -> None:
        """Fit the model again from values of the user."""
        self._tree.fit_from(values)
        self._settle()

    def simulate(self, values: Mapping[str, float]) -> dict[str, Any]:
        """Return the curve of the model with values of the user."""
        pv = self._tree.simulate(values)
        return {"pv": curve_json(pv, len(pv))}

    def against(self, axis: str) -> dict[str, Any]:
        """Return the residual against an axis."""
        return axis_json(self._tree, axis)

    def validate(self, opening: Opening) -> None:
        """Score each step on another recording of the loop; nothing is fitted to it."""
        from agent.workbench.session.opening import other_record  # noqa: PLC0415

        window, _ = _read(opening)
        self._tree.validation = other_record(window, self._tree.node.bench.base)
        self._state()

    def names(self) -> list[str]:
        """Return the columns of the recording, as its header has them."""
        return [] if self._opening is None else _names(self._opening)

    def report(self) -> str:
        """Return the page of the steps on the way to the one that is looked at."""
        from agent.plots.workbench.comparison_figures import comparison_figures  # noqa: PLC0415
        from agent.plots.workbench.report import report_html  # noqa: PLC0415

        found, node = self._tree.compared(), self._tree.node
        node.bench.restore(node.steps)
        return report_html(found, comparison_figures(node.bench, found))

    def _settle(self) -> None:
        """Send the model at once, and again when its candidates were tried."""
        self._state()
        if self._tree.reason is None and self._tree.node.comparison is None:
            self._tree.compared()
            self._state()

    def _state(self) -> None:
        if self._opening is not None:
            given = {role: name for role, name in (self._opening.columns or {}).items() if name}
            source = ReadSource(self._opening.name, given, self._opening.loop)
            self._send("state", tree_json(self._tree, source, self._columns))

    def _progress(self, what: str, done: int, of: int, /) -> None:
        self._send("progress", {"what": what.replace("_", " "), "done": done, "of": of})


def _read(opening: Opening) -> tuple[Any, dict[str, str]]:
    """Return the window of a recording, and the column of each role."""
    from agent.analysis.record.window_of_recording import loop_window  # noqa: PLC0415
    from connectors.recording import STANDARD, Columns, RecordingError, read_recording  # noqa: PLC0415

    own = {role.lower(): name for role, name in (opening.columns or {}).items() if name}
    names = {each: own.get(each, getattr(STANDARD, each)) for each in ("time", "op", "pv", "sp")}
    try:
        columns = Columns(**names, ts=_sampling_time(own.get("ts")))
        recording = replace(read_recording(opening.file, columns, None, opening.loop), mode=None)
        return loop_window(recording), dict(recording.tags)
    except RecordingError as error:
        raise RecordingError(
            *(each.replace(str(opening.file), opening.name) for each in error.faults)
        ) from error
    except (TypeError, ValueError) as error:
        raise ValueError(f"{opening.name}: {error}") from error


def _sampling_time(given: str | None) -> float | None:
    """Return the sampling time that was given, s; raises ValueError where it is none."""
    if given is None:
        return None
    ts = float(given)
    if not 0 < ts < math.inf:
        raise ValueError(f"the sampling time is {given}, expected seconds above 0")
    return ts


def _names(opening: Opening) -> list[str]:
    """Return the columns of a file, to choose from; none where it is no table."""
    from connectors.exports.reading import sheets_of_file  # noqa: PLC0415

    try:
        columns = sheets_of_file(opening.file)[0].columns
    except (ConfigError, ValueError):
        return []
    return [each.name for each in columns if each.name][:MOST_NAMES]


def work(connection: Any) -> None:  # noqa: ANN401 - a multiprocessing connection
    """Obey what comes through a pipe until it ends; the body of the session's process.

    A message is (number, name of a method of ``Desk``, arguments). Its end is answered by ``done`` with the
    number, what the method returned, and in words what was wrong with the command; None where nothing was.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    step_back(NICE)

    def send(kind: str, content: object) -> None:
        with contextlib.suppress(OSError):  # nobody reads any more: the next recv ends it
            connection.send((kind, content))

    desk = Desk(send)
    with _pool() as run:
        while True:
            try:
                number, name, arguments = connection.recv()
            except (EOFError, OSError):
                return
            fault, answer = None, None
            try:
                extra = (run,) if name == "open" else ()
                answer = getattr(desk, name)(*arguments, *extra)
            except ConfigError as error:
                fault = "; ".join(error.faults)
            except ValueError as error:
                fault = str(error)
            send("done", (number, answer, fault))


@contextlib.contextmanager
def _pool() -> Iterator[Any]:
    """Yield a map that works on all cores."""
    from agent.runtime.loop.process_pool import process_pool  # noqa: PLC0415

    if cores() == 1:
        yield map
        return
    with process_pool(cores()) as pool:
        yield pool.map
