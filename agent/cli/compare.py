"""``slipjump compare``: which physical effect is missing in a recording, added until nothing more is."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common import read_options as reading
from agent.cli.common import recordings as option
from agent.cli.common.compilation import announce_compilation
from agent.cli.common.errors import BAD_INPUT, complain

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.physics.effect import Effect
    from agent.workbench.comparison import Comparison
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.session import Workbench
    from connectors.recording import ReadOptions

Names = list[str]


def compare(
    recording: Annotated[Path, typer.Argument(metavar="RECORDING", help="CSV or Parquet file.")],
    *,
    validate: Annotated[
        Path | None,
        typer.Option(
            metavar="OTHER", help="Another recording of the loop: every step is scored on it, none fitted."
        ),
    ] = None,
    base: Annotated[
        str, typer.Option(metavar="NAME", help="Process to begin with: fopdt, sopdt, integrator, two_tanks.")
    ] = "fopdt",
    load: Annotated[
        Path | None, typer.Option(metavar="MODEL.yaml", help="Begin with the effects of a saved model.")
    ] = None,
    add: Annotated[
        Names | None, typer.Option(metavar="EFFECT", help="Add this effect; may be repeated.")
    ] = None,
    drop: Annotated[
        Names | None, typer.Option(metavar="EFFECT", help="Then take this one out; may be repeated.")
    ] = None,
    without: Annotated[
        Names | None,
        typer.Option(metavar="EFFECT", help="Do not try this effect or family; repeatable."),
    ] = None,
    auto: Annotated[bool, typer.Option("--auto", help="Add what is confirmed, until nothing is.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="Write a page with pictures to this file.")
    ] = None,
    save: Annotated[
        Path | None, typer.Option(metavar="MODEL.yaml", help="Write the last model to this file.")
    ] = None,
    time: option.Time = "time",
    op: option.Op = "OP",
    pv: option.Pv = "PV",
    sp: option.Sp = "SP",
    mv: option.Mv = "MV",
    mode: option.Mode = "mode",
    ts: option.Ts = None,
    loop: option.Loop = None,
    zone: reading.Zone = None,
    time_format: reading.TimeFormat = None,
    date_order: reading.Order = None,
    decimal: reading.DecimalMark = None,
    pattern: reading.Pattern = None,
    modes: reading.Modes = None,
    mapping: reading.MappingFile = None,
) -> None:
    """Compare a recording with a model, and learn which physical effect the model lacks."""
    from connectors.recording import Columns

    columns = Columns(time, op, pv, sp, mv, mode, option.positive(ts))
    options = reading.read_options(columns, zone, time_format, date_order, decimal, pattern, mapping, modes)
    effects = _effects()
    _check_names(base, [*(add or ()), *(drop or ())], effects)
    window = _window(recording, options, loop)
    other = None if validate is None else _window(validate, options, loop)
    with ExitStack() as stack:
        progress = stack.enter_context(_progress())
        run = stack.enter_context(_pool())
        from agent.workbench.session import Workbench

        try:
            bench = Workbench(window, base, other, without or (), effects=effects, run=run, progress=progress)
            if bench.reason is None:
                _steps(bench, load, add or (), drop or ())
                if auto:
                    bench.auto()
            found = bench.comparison()
        except ValueError as error:
            raise typer.BadParameter(str(error)) from error
        except BrokenProcessPool as error:
            complain(f"{recording}: not compared: a process was ended, for want of memory or by somebody")
            raise typer.Exit(BAD_INPUT) from error
    written = [True]
    if save is not None:
        written.append(_save(bench, save))
    if report is not None:
        written.append(_report(bench, found, report))
    if as_json:
        from agent.report.comparison_json import comparison_json

        text = json.dumps(comparison_json(found, recording.name), allow_nan=False)
    else:
        from agent.report.comparison_text import comparison_lines

        text = "\n".join(comparison_lines(found))
    print(text, flush=True)  # noqa: T201 - this is the command's output
    if not all(written):
        raise typer.Exit(BAD_INPUT)


def _effects() -> tuple[Effect, ...]:
    """Return the effects that may be tried; name each installed one that is left out, and why."""
    from agent.checks.plug_ins import usable_effects

    found = usable_effects()
    for line in found.left_out:
        complain(line)
    return found.effects


def _check_names(base: str, names: Iterable[str], effects: Sequence[Effect]) -> None:
    """Refuse what does not exist before anything is read."""
    from agent.workbench.library import base_named, effect_named

    try:
        base_named(base)
        for name in names:
            effect_named(name, effects)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error


def _window(path: Path, options: ReadOptions, loop: str | None) -> LoopWindow:
    from agent.analysis.record.recording import LoopHints
    from connectors.recording import read_recording

    return option.window_of(read_recording(path, options.columns, options, loop), LoopHints())


def _steps(bench: Workbench, load: Path | None, add: Iterable[str], drop: Iterable[str]) -> None:
    if load is not None:
        try:
            bench.load(_mapping(load))
        except ValueError as error:
            raise ValueError(f"{load}: {error}") from error
    for name in add:
        bench.add(name)
    for name in drop:
        bench.drop(name)


def _mapping(path: Path) -> object:
    """Return what a YAML file holds.

    Raises:
        ValueError: it cannot be read.
    """
    import yaml

    try:
        return yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ValueError(" ".join(str(error).split())) from error


def _save(bench: Workbench, path: Path) -> bool:
    """Write the last model; return whether it could be written."""
    import yaml

    if bench.reason is not None:
        complain(f"{path}: not written: the recording is not testable")
        return True
    return _write(path, yaml.safe_dump(bench.save(), sort_keys=False))


def _report(bench: Workbench, found: Comparison, path: Path) -> bool:
    """Write the page; return whether it could be written."""
    from agent.plots.workbench.comparison_figures import comparison_figures
    from agent.plots.workbench.report import report_html

    return _write(path, report_html(found, comparison_figures(bench, found)))


def _write(path: Path, text: str) -> bool:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        complain(f"{path}: cannot be written: {error.strerror}")
        return False
    return True


@contextmanager
def _pool() -> Iterator[Map]:
    """Yield a map that works on all cores."""
    from agent.runtime.capabilities import cores, import_before_start

    workers = cores()
    if workers == 1:
        announce_compilation(threading.Event())
        yield map
        return
    from agent.runtime.loop.process_pool import CONTEXT, process_pool

    import_before_start(CONTEXT, ["agent.workbench.session"])
    told = CONTEXT.Event()
    announce_compilation(told)
    with process_pool(workers, announce_compilation, told) as pool:
        yield pool.map


@contextmanager
def _progress() -> Iterator[Progress]:
    """Name on a terminal's stderr what is being tried."""
    from agent.workbench.hooks import silent

    if not sys.stderr.isatty():
        yield silent
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("trying {task.description:24}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, redirect_stdout=False, transient=True) as progress:
        work = progress.add_task("", total=1)

        def shown(what: str, done: int, of: int, /) -> None:
            progress.update(work, description=what.replace("_", " "), completed=done, total=of)

        yield shown
