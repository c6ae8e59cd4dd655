"""``slipjump compare``: which physical effect is missing in a recording, added until nothing more is."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common import read_options as reading
from agent.cli.common import recordings as option
from agent.cli.common.errors import BAD_INPUT, complain
from agent.cli.common.window import remarks_on, window_of
from agent.cli.comparing import several
from agent.cli.comparing.hooks import pool_of_cores, progress_on_terminal
from agent.cli.comparing.names import check_names, named_columns, usable
from agent.cli.comparing.outputs import deliver, mapping_of, write_together

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.cli.comparing.several import Recorded
    from agent.physics.effect import Effect
    from agent.workbench.comparison import Comparison
    from agent.workbench.session import Workbench
    from connectors.recording import ReadOptions

Names = list[str]
BASE_HELP = (
    "Process to begin with: fopdt, sopdt, integrator, lags_integrator, oscillatory, third_order, "
    "two_tanks, heater, heat_exchanger, neutralisation, or auto: the likeliest."
)


def compare(
    recordings: Annotated[
        list[Path],
        typer.Argument(
            metavar="RECORDING...",
            help="CSV, Parquet, Excel or MAT-file; several of one loop: one model over all.",
        ),
    ],
    *,
    validate: Annotated[
        Path | None,
        typer.Option(
            metavar="OTHER", help="Another recording of the loop: every step is scored on it, none fitted."
        ),
    ] = None,
    base: Annotated[str, typer.Option(metavar="NAME", help=BASE_HELP)] = "fopdt",
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
    effect: Annotated[
        Names | None,
        typer.Option(
            metavar="FILE.py:CLASS", help="An effect of your own in a file: docs/howto/own_effect.md."
        ),
    ] = None,
    measured: Annotated[
        Names | None,
        typer.Option(
            "--input",
            metavar="NAME=COLUMN",
            help="A measured input beside OP, a feed or a second actuator, tried like an effect; repeatable.",
        ),
    ] = None,
    own: Annotated[
        Names | None,
        typer.Option(
            metavar="PARAMETER",
            help="Of several recordings: each has its own, as of a valve that wears; repeatable.",
        ),
    ] = None,
    auto: Annotated[bool, typer.Option("--auto", help="Add what is confirmed, until nothing is.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="Write a page with pictures to this file.")
    ] = None,
    save: Annotated[
        Path | None, typer.Option(metavar="MODEL.yaml", help="Write the last model to this file.")
    ] = None,
    page: Annotated[
        bool, typer.Option("--page", help="Open the workbench in the browser, as slipjump workbench does.")
    ] = False,
    guided: Annotated[
        bool | None,
        typer.Option(
            "--guided/--no-guided",
            help="A conversation, step by step; the default on a terminal where no step is named.",
        ),
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
    start: reading.Start = None,
    end: reading.End = None,
) -> None:
    """Compare a recording with a model, and learn which physical effect the model lacks."""
    from connectors.recording import Columns

    columns = Columns(time, op, pv, sp, mv, mode, option.positive(ts))
    options = reading.read_options(
        columns, zone, time_format, date_order, decimal, pattern, mapping, modes, start, end
    )
    effects = usable(effect or ())
    inputs = named_columns(measured or ())
    check_names(base, [each for each in (*(add or ()), *(drop or ())) if each not in inputs], effects)
    if len(recordings) > 1:
        several.refuse_options(
            {
                "--load": load,
                "--add": add,
                "--drop": drop,
                "--save": save,
                "--page": page,
                "--guided": guided,
            }
        )
        recorded = [_recorded(each, options, loop, inputs) for each in recordings]
        named = dict(zip(several.names_of(recordings), recorded, strict=True))
        scored = None if validate is None else _recorded(validate, options, loop, inputs)
        _several(named, base, without or (), effects, own or (), scored, report, auto=auto, as_json=as_json)
        return
    if own:
        raise typer.BadParameter("one recording has nothing of its own", param_hint="--own")
    recording = recordings[0]
    if page:
        from agent.cli.comparing.workbench import open_page

        open_page(recording, base)
        return
    window, measured_there = _recorded(recording, options, loop, inputs)
    other, elsewhere = (None, {}) if validate is None else _recorded(validate, options, loop, inputs)
    if _is_guided(guided, named=bool(load or add or drop or inputs or auto or as_json or report or save)):
        from agent.cli.comparing.guide import Question, guide

        files = tuple(each for each in (recording, validate, mapping) if each is not None)
        guide(Question(window, base, other, tuple(without or ()), effects, files, repr((options, loop))))
        return
    with ExitStack() as stack:
        progress = stack.enter_context(progress_on_terminal())
        run = stack.enter_context(pool_of_cores())
        from agent.workbench.session import Workbench

        try:
            bench = Workbench(
                window,
                base,
                other,
                without or (),
                effects=effects,
                inputs=measured_there,
                other_inputs=elsewhere,
                run=run,
                progress=progress,
            )
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
    done = deliver(bench, found, save, report)
    print(_text(found, recording.name if as_json else None), flush=True)  # noqa: T201 - the command's output
    if not done:
        raise typer.Exit(BAD_INPUT)


def _several(
    recorded: Mapping[str, Recorded],
    base: str,
    without: Sequence[str],
    effects: Sequence[Effect],
    own: Sequence[str],
    other: Recorded | None,
    report: Path | None,
    *,
    auto: bool,
    as_json: bool,
) -> None:
    """Compare recordings of one loop with one model, write the report and print the answer."""
    with ExitStack() as stack:
        progress = stack.enter_context(progress_on_terminal())
        run = stack.enter_context(pool_of_cores())
        try:
            found = several.together(
                recorded, base, without, effects, own, run, progress, auto=auto, validate=other
            )
        except ValueError as error:
            raise typer.BadParameter(str(error)) from error
    written = report is None or write_together(found, report)
    text = several.together_json(found) if as_json else "\n".join(several.together_lines(found))
    print(text, flush=True)  # noqa: T201 - the command's output
    if not written:
        raise typer.Exit(BAD_INPUT)


def _text(found: Comparison, recording: str | None) -> str:
    """Return a comparison as JSON where the name of its file is given, else in words."""
    if recording is None:
        from agent.report.comparison_text import comparison_lines

        return "\n".join(comparison_lines(found))
    from agent.report.comparison_json import comparison_json

    return json.dumps(comparison_json(found, recording), allow_nan=False)


def _is_guided(guided: bool | None, *, named: bool) -> bool:  # noqa: FBT001 - an option of three values
    """Return whether to talk: where it was chosen, or on a terminal where no step is ``named``.

    Raises:
        BadParameter: It was chosen, and steps are named.
    """
    if guided and named:
        raise typer.BadParameter("the conversation takes no steps or files as options", param_hint="--guided")
    terminal = sys.stdin.isatty() and sys.stdout.isatty()
    return bool(guided) or (guided is None and not named and terminal)


def _window(path: Path, options: ReadOptions, loop: str | None) -> LoopWindow:
    from agent.analysis.record.recording import LoopHints
    from connectors.recording import read_recording

    # In manual OP moves the valve as well: a bump test is the best record that there is.
    recording = replace(read_recording(path, options.columns, options, loop), mode=None)
    complain(*remarks_on(recording))
    return window_of(recording, LoopHints())


def _recorded(
    path: Path, options: ReadOptions, loop: str | None, inputs: Mapping[str, str]
) -> tuple[LoopWindow, dict[str, FloatArray]]:
    """Return a recording and its measured inputs by their names, each on its time grid."""
    from connectors.recording import RecordingError

    window, found = _window(path, options, loop), {}
    for name, column in inputs.items():
        try:
            other = _window(path, replace(options, columns=replace(options.columns, mv=column)), loop)
        except RecordingError as error:
            raise RecordingError(str(error).replace("--mv", "--input NAME=COLUMN")) from error
        if other.mv is not None:
            found[name] = other.mv
    return window, found


def _steps(bench: Workbench, load: Path | None, add: Iterable[str], drop: Iterable[str]) -> None:
    if load is not None:
        try:
            bench.load(mapping_of(load))
        except ValueError as error:
            raise ValueError(f"{load}: {error}") from error
    for name in add:
        bench.add(name)
    for name in drop:
        bench.drop(name)
