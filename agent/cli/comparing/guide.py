"""Opens the session of a recording, or goes on with the kept one, and talks until the user quits."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from agent.cli.common.errors import BAD_INPUT, complain
from agent.cli.comparing.conversation import Conversation, Files, Print, Read
from agent.cli.comparing.hooks import TerminalProgress, pool_of_cores, progress_on_terminal
from agent.cli.comparing.kept_sessions import read_session, session_key, sessions_folder, write_session
from agent.cli.comparing.outputs import report_part, save_model, write_report

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.physics.effect import Effect
    from agent.workbench.comparison import Comparison
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.session import Workbench

PACKAGES = ("agent.workbench", "agent.physics", "agent.analysis")
"""Whose code a kept session depends on."""


@dataclass(frozen=True, slots=True)
class Question:
    """What a session is about: whoever compares the same again goes on with it."""

    window: LoopWindow
    base: str
    validate: LoopWindow | None
    without: tuple[str, ...]
    effects: Sequence[Effect]
    files: tuple[Path, ...]
    """That were read."""
    options: str
    """How they were read."""


def guide(question: Question) -> None:
    """Talk on stdin and stdout; exit with 2 where the recording cannot be compared."""
    folder, key = sessions_folder(), session_key(_parts(question))
    with ExitStack() as stack:
        run = stack.enter_context(pool_of_cores())
        progress = stack.enter_context(progress_on_terminal())
        try:
            bench = _resumed(folder, key, run, progress) or _opened(question, run, progress)
            progress.rest()
            if bench.reason is not None:
                _show(f"{question.window.loop}: not testable: {bench.reason}")
                return
            report_part(bench)
            read, show = quietly(progress)
            Conversation(bench, read, show, FILES, lambda each: _keep(folder, key, each)).run()
        except BrokenProcessPool as error:
            complain(f"{question.files[0]}: a process was ended, for want of memory or by somebody")
            raise typer.Exit(BAD_INPUT) from error


def quietly(progress: TerminalProgress) -> tuple[Read, Print]:
    """Return reader and printer of a conversation, before which the line of progress is taken away."""

    def read(prompt: str) -> str | None:
        progress.rest()
        return _read(prompt)

    def show(line: str) -> None:
        progress.rest()
        _show(line)

    return read, show


def _resumed(folder: Path, key: str, run: Map, progress: TerminalProgress) -> Workbench | None:
    from agent.workbench.session.kept import loaded

    data = read_session(folder, key)
    if data is None:
        return None
    try:
        bench = loaded(data, run, progress)
    except ValueError:
        return None
    progress.rest()
    names = " + ".join((bench.base.name, *bench.step.effects))
    _show(f"goes on with the kept session, {len(bench.staircase())} steps: {names} (undo goes back)")
    return bench


def _opened(question: Question, run: Map, progress: Progress) -> Workbench:
    from agent.workbench.session import Workbench

    try:
        return Workbench(
            question.window,
            question.base,
            question.validate,
            question.without,
            effects=question.effects,
            run=run,
            progress=progress,
        )
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error


def _keep(folder: Path, key: str, bench: Workbench) -> None:
    from agent.workbench.session.kept import dumped

    try:
        write_session(folder, key, dumped(bench))
    except OSError as error:
        complain(f"{folder}: the session cannot be kept: {error.strerror}")


def _parts(question: Question) -> Iterator[bytes]:
    """Yield all that the answers depend on."""
    yield from (path.read_bytes() for path in question.files)
    yield repr((question.base, question.without, question.options)).encode()
    for package in PACKAGES:
        spec = find_spec(package)
        for place in (spec.submodule_search_locations or ()) if spec is not None else ():
            for path in sorted(Path(place).rglob("*.py")):
                yield path.read_bytes()
    for each in question.effects:
        yield repr(each).encode()
        source = getattr(sys.modules.get(type(each).__module__), "__file__", None)
        if source is not None:
            yield Path(source).read_bytes()


def _read(prompt: str) -> str | None:
    try:
        return input(prompt)
    except EOFError:
        return None


def _show(line: str) -> None:
    print(line, flush=True)  # noqa: T201 - this is the command's output


def _report(bench: Workbench, found: Comparison, path: str) -> str:
    return f"written: {path}" if write_report(bench, found, Path(path)) else f"not written: {path}"


def _model(bench: Workbench, path: str) -> str:
    return f"written: {path}" if save_model(bench, Path(path)) else f"not written: {path}"


FILES = Files(_report, _model)
