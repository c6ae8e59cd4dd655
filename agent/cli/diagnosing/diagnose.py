"""``slipjump diagnose``: recordings in, diagnoses out."""

from __future__ import annotations

from collections import Counter
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common import read_options as reading
from agent.cli.common import recordings as option
from agent.cli.common.delay import delay_of
from agent.cli.common.errors import BAD_INPUT, complain
from agent.cli.common.pictures import picture_files
from agent.cli.diagnosing.answer import Task
from agent.cli.diagnosing.fleet import Fleet
from agent.cli.diagnosing.one_valve import together, valves
from agent.cli.diagnosing.plant import PlantLoops
from agent.cli.diagnosing.work import answers, get_ready, progress_of

if TYPE_CHECKING:
    from agent.analysis.quantify import Quantifier
    from connectors.recording import ReadOptions


class Acting(StrEnum):
    """Which way a controller acts."""

    REVERSE = "reverse"
    DIRECT = "direct"


def diagnose(
    recordings: option.Recordings,
    *,
    quantifier: Annotated[
        str | None, typer.Option(metavar="NAME", help="How stiction is measured: free_run, lee2008, ...")
    ] = None,
    delay: Annotated[
        str | None,
        typer.Option(
            metavar="D",
            help="Dead time, if known: whole samples (4), or a time with its unit (17s, 2min, 500ms). "
            "PV depends first on MV(t-D).",
        ),
    ] = None,
    order: Annotated[
        int | None, typer.Option(min=1, max=2, help="Order of the process model, 1 or 2, if known.")
    ] = None,
    acting: Annotated[
        Acting | None,
        typer.Option(help="Controller action, if known: reverse, OP falls when PV rises; direct, OP rises."),
    ] = None,
    integrating: Annotated[
        bool | None,
        typer.Option(
            "--integrating/--self-regulating", help="Whether PV integrates the flow (levels), if known."
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON object a line for each recording.")
    ] = False,
    each: Annotated[
        bool,
        typer.Option("--each", help="Every recording alone, also those that are named for one valve."),
    ] = False,
    one_valve: Annotated[
        bool,
        typer.Option("--one-valve", help="All recordings are of one valve, whatever they are named."),
    ] = False,
    plant: Annotated[
        bool,
        typer.Option(
            "--plant",
            help="The recordings are loops of one plant: report which of them oscillate together, where that "
            "begins most probably, and the way it takes. With --plot a picture, DIR/plant.png.",
        ),
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Draw into DIR: NAME.png, measurement and model; NAME-contour.png, which f_S and f_D "
            "explain the record; NAME-profile.png, S against delay and J, where they are estimated.",
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Write all valves to FILE.html, FILE.pdf or FILE.csv: the most urgent first, with small "
            "pictures, why and what to do next, and the quality of the records.",
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
    """Report from recordings whether the valve sticks, and by how much.

    Recordings of one valve are diagnosed together: those of one folder named by
    the same tag with a number or a date behind, as FIC101_1.csv, FIC101_2.csv.
    What is undecided alone may so be decided; what is firm alone stays. What
    they show together is the first reason of each.
    """
    files = option.in_folders(recordings)
    get_ready(len(files), pictures=plot is not None)  # first: it goes on beside what follows
    from agent.analysis.record.recording import LoopHints
    from connectors.recording import Columns

    columns = Columns(time, op, pv, sp, mv, mode, option.positive(ts))
    hints = LoopHints(integrating, acting.value if acting else None, order=order)
    known = None if delay is None else delay_of(delay)
    method = None if quantifier is None else _method(quantifier)
    if one_valve and (each or plant or (method is not None and not _shares_evidence(method))):
        other = (
            "--each and --plant say the contrary"
            if each or plant
            else f"--quantifier {quantifier} has no evidence to share"
        )
        raise typer.BadParameter(f"{other}: take one of them", param_hint="'--one-valve'")
    options = reading.read_options(
        columns, zone, time_format, date_order, decimal, pattern, mapping, modes, start, end
    )
    entries = [each for path in files for each in _loops(path, options, loop)]
    names = [path if name is None else path.with_name(f"{name}.csv") for path, name in entries]
    valve = valves(names, each=each or plant, one_valve=one_valve)
    recordings_of = Counter(valve)
    fleet = Fleet(names, valve, report)
    pictures = picture_files(names, plot)
    tasks = [
        Task(
            path,
            columns,
            hints,
            method,
            picture,
            options,
            name,
            known,
            shared=plant or recordings_of[of] > 1,
            small_picture=report is not None,
            as_json=as_json,
        )
        for (path, name), picture, of in zip(entries, pictures, valve, strict=True)
    ]
    failed, whole = False, PlantLoops(plot) if plant else None
    remarked: set[str] = set()
    with progress_of(len(tasks)) as advance:
        for place, answer in enumerate(together(answers(tasks, advance), valve)):
            failed |= bool(answer.faults)
            complain(*answer.faults, *(each for each in answer.remarks if each not in remarked))
            remarked.update(answer.remarks)
            fleet.add(place, answer)
            if answer.found is not None:
                print(answer.found.text, flush=True)  # noqa: T201 - this is the command's output
                if whole is not None:
                    whole.add(answer)
    if not as_json:
        for line in fleet.table():
            print(line, flush=True)  # noqa: T201 - this is the command's output
    failed |= not fleet.write()
    if whole is not None:
        failed |= not whole.say(as_json=as_json)
    if failed:
        raise typer.Exit(BAD_INPUT)


def _loops(path: Path, options: ReadOptions, loop: str | None) -> list[tuple[Path, str | None]]:
    """Return a file once for each of its loops; None stands for the only one, or for one that is not read."""
    from connectors.base import ConfigError
    from connectors.recording import loops_in

    if loop is not None:
        return [(path, loop)]
    try:
        names = loops_in(path, options)
    except ConfigError:
        return [(path, None)]  # its worker reports the fault in its place
    return [(path, None)] if len(names) == 1 else [(path, name) for name in names]


def _method(name: str) -> Quantifier:
    from agent.analysis.quantify import quantifier

    try:
        return quantifier(name)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--quantifier'") from error


def _shares_evidence(quantifier: Quantifier) -> bool:
    from agent.analysis.diagnose import DEFAULT_QUANTIFIER

    return quantifier.name == DEFAULT_QUANTIFIER
