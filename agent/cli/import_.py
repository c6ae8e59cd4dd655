"""``slipjump import``: what is in a file of a historian, and how it will be read."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common import read_options as reading
from agent.cli.common import recordings as option
from agent.cli.common.columns import aligned
from agent.cli.common.errors import BAD_INPUT, complain
from agent.cli.common.window import window_of

if TYPE_CHECKING:
    from agent.report.export_summary import LoopSummary
    from connectors.recording import Export, ReadOptions


def import_(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="CSV, text, gz, zip, Excel, Parquet or MAT-file: one loop or many."
        ),
    ],
    *,
    preview: Annotated[
        bool, typer.Option("--preview", help="Print what was understood, write nothing.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="The preview as one JSON object.")] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="MAPPING.yaml", help="Where to write it.  [default: FILE.yaml]"
        ),
    ] = None,
    time: option.Time = "time",
    op: option.Op = "OP",
    pv: option.Pv = "PV",
    sp: option.Sp = "SP",
    mv: option.Mv = "MV",
    mode: option.Mode = "mode",
    ts: option.Ts = None,
    zone: reading.Zone = None,
    time_format: reading.TimeFormat = None,
    date_order: reading.Order = None,
    decimal: reading.DecimalMark = None,
    pattern: reading.Pattern = None,
    modes: reading.Modes = None,
    mapping: reading.MappingFile = None,
) -> None:
    """Show what a file of a historian holds, and write how to read it to a mapping file.

    Loops, columns, times, numbers and qualities are recognised. What can be
    read in two ways is refused, and the message names the option that settles
    it. The mapping file can be corrected; diagnose, compare and replay take it
    by --mapping.
    """
    from connectors.exports.mapping import mapping_text
    from connectors.recording import Columns, read_export

    columns = Columns(time, op, pv, sp, mv, mode, option.positive(ts))
    options = reading.read_options(columns, zone, time_format, date_order, decimal, pattern, mapping, modes)
    export = read_export(file, options)
    summaries, problems = _summaries(export, options)
    if as_json:
        from agent.report.export_summary import summary_json

        found = summary_json(file.name, export.format, export.zone, summaries, problems)
        print(json.dumps(found, allow_nan=False))  # noqa: T201 - the command's output
    else:
        _print(export, summaries, problems)
    if preview or as_json:
        return
    target = output or file.with_name(f"{file.name}.yaml")
    if output is None and target.exists():
        complain(f"{target}: is there already; --output names another, or the same to replace it")
        raise typer.Exit(BAD_INPUT)
    try:
        target.write_text(mapping_text(export, options), encoding="utf-8")
    except OSError as error:
        complain(f"{target}: cannot be written: {error.strerror}")
        raise typer.Exit(BAD_INPUT) from error
    print(f"mapping: {target} (correct it, then: slipjump diagnose {file} --mapping {target})")  # noqa: T201


def _summaries(export: Export, options: ReadOptions) -> tuple[list[LoopSummary], list[str]]:
    """Return a summary of each loop, and what was left out or may be wrong."""
    from agent.analysis.record.recording import LoopHints
    from agent.report.export_summary import loop_summary, problems_of
    from connectors.recording import RecordingError

    summaries: list[LoopSummary] = []
    problems = list(export.problems)
    for loop in export.loops:
        try:
            window = window_of(loop, LoopHints())
        except RecordingError as error:
            problems.append(f"{loop.name}: {error.faults[0]}")
            continue
        dated = bool(export.zone) and options.columns.ts is None
        summaries.append(
            loop_summary(replace(window, loop=loop.name), dict(loop.tags), loop.bad, dated=dated)
        )
    return summaries, [*problems, *problems_of(summaries)]


def _print(export: Export, summaries: list[LoopSummary], problems: list[str]) -> None:
    from agent.report.export_summary import absent_words, summary_rows

    times = {"samples": "counted by --ts", "calendar": "dates"}.get(export.time_form, export.time_form)
    zone = {"": "", "as written": ", zone as written"}.get(export.zone, f" in {export.zone}")
    how = f"{export.kind}, layout {export.format}, times {times}{zone}, decimal mark {export.decimal}"
    table = aligned(summary_rows(summaries))
    notes = (*(f"! {each}" for each in problems), *(f"- {each}" for each in absent_words(summaries)))
    lines = [f"{export.path.name}: {how}", *table, *notes]
    print("\n".join(lines))  # noqa: T201 - the command's output
