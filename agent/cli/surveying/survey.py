"""``slipjump survey``: an archive of loops in, a table and a ranking out."""

from __future__ import annotations

import signal
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common import read_options as reading
from agent.cli.common import recordings as option
from agent.cli.common.errors import BAD_INPUT, complain

if TYPE_CHECKING:
    from agent.runtime.survey.executor import BatchExecutor
    from agent.runtime.survey.local_processes import LocalProcesses

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""
Sources = Annotated[
    list[str],
    typer.Argument(
        metavar="SOURCE...", help="Folders with all that is in them, files, or patterns as 'plant/*/*.csv'."
    ),
]
Folder = Annotated[
    Path,
    typer.Option(
        "--output", "-o", metavar="FOLDER", help="Where survey.parquet and survey.html are written."
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        metavar="SCHEDULER",
        help="Work on the machines of a dask scheduler, as tcp://host:8786, not on this one.",
    ),
]
Workers = Annotated[
    int | None, typer.Option(min=1, metavar="N", help="Processes on this machine.  [default: all cores]")
]


def survey(
    sources: Sources,
    *,
    output: Folder,
    cluster: Cluster = None,
    workers: Workers = None,
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
    start: reading.Start = None,
    end: reading.End = None,
) -> None:
    """Diagnose an archive of loops on all cores, and rank the valves.

    FOLDER/survey.parquet has a row a loop, with the keys of diagnose --json
    joined by dots. FOLDER/survey.html ranks the valves, the most urgent first.

    After an interruption, however it came, the same command goes on: each loop
    is kept in FOLDER/survey.sqlite as soon as it is done. Files that are new or
    changed are diagnosed, the others are not diagnosed again.
    """
    from agent.analysis.record.recording import LoopHints
    from agent.cli.surveying.progress import progress
    from agent.cli.surveying.results import survey_words, write_results
    from agent.runtime.store.database import StoreError
    from agent.runtime.store.lock import only_user_of
    from agent.runtime.survey.ledger import Ledger
    from agent.runtime.survey.survey import survey as run
    from connectors.base import ConfigError
    from connectors.recording import Columns
    from connectors.sources.archive import archive_name, parts_of

    columns = Columns(time, op, pv, sp, mv, mode, option.positive(ts))
    options = reading.read_options(
        columns, zone, time_format, date_order, decimal, pattern, mapping, modes, start, end
    )
    executor = _executor(cluster, workers)
    parts = parts_of(sources, without=output)
    file = output / "survey.sqlite"
    try:
        output.mkdir(parents=True, exist_ok=True)
        with only_user_of(file, "survey"), closing(Ledger(file, archive_name(sources))) as ledger:
            try:
                with progress() as watcher:
                    summary = run(parts, options, LoopHints(), executor, ledger, watcher)
            except KeyboardInterrupt:
                complain(f"interrupted; {len(ledger.done())} loops are done, the same command goes on")
                raise typer.Exit(INTERRUPTED) from None
            rows = write_results(output, ledger, summary)
    except (StoreError, OSError) as error:
        raise ConfigError([str(error)]) from error
    print(survey_words(output, rows, summary))  # noqa: T201 - this is the command's output
    if summary.faults:
        raise typer.Exit(BAD_INPUT)


def _executor(cluster: str | None, workers: int | None) -> BatchExecutor:
    if cluster is not None:
        if workers is not None:
            raise typer.BadParameter("a cluster has its own workers", param_hint="'--workers'")
        from agent.runtime.survey.dask_cluster import DaskCluster

        return DaskCluster(cluster)
    return local_processes(workers)


def local_processes(workers: int | None = None) -> LocalProcesses:
    """Return processes of this machine, prepared for diagnoses; None: one for each core."""
    from agent.runtime.capabilities import cores
    from agent.runtime.loop.process_pool import CONTEXT, import_early
    from agent.runtime.survey.local_processes import LocalProcesses

    import_early(["agent.analysis.diagnose"])
    return LocalProcesses(workers or cores(), _prepare, CONTEXT.Event())


def _prepare(announced: object) -> None:
    """Prepare a worker: Ctrl-C goes to the whole group of processes, and only the survey acts on it."""
    from agent.cli.common.compilation import announce_compilation

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    announce_compilation(announced)  # type: ignore[arg-type]
