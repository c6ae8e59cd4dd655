"""``slipjump history``: what an agent found and what became of its alarms."""

from __future__ import annotations

import json
from contextlib import closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from agent.cli.common.state_file import ConfigPath, StatePath, opened, state_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from agent.runtime.samples.postgres_samples import PostgresSamples
    from agent.runtime.samples.sample_file import SampleFile
    from agent.runtime.store.history_file import Entry, HistoryFile
    from agent.runtime.store.postgres_history import PostgresHistory
    from agent.settings import HistoryDatabase

KeptT = TypeVar("KeptT", "PostgresHistory", "PostgresSamples")
LAST = 50
"""Entries shown by default."""


def history(
    state: StatePath = None,
    config: ConfigPath = None,
    *,
    loop: Annotated[str | None, typer.Option(metavar="LOOP", help="Of this loop only.")] = None,
    since: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="From this time on, ISO 8601 (UTC where it does not say)."),
    ] = None,
    last: Annotated[int, typer.Option(min=1, max=1_000_000, help="Number of entries, the newest.")] = LAST,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line.")] = False,
    trend: Annotated[
        bool, typer.Option("--trend", help="S against time instead: repairs, slope, forecast; all entries.")
    ] = False,
    limit: Annotated[
        float | None, typer.Option(min=0, metavar="S", help="With --trend: when S reaches it, OP units.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="DIR", help="With --trend: draw LOOP-trend.png into DIR.")
    ] = None,
    windows: Annotated[
        bool, typer.Option("--windows", help="The windows whose values are kept instead, with their ids.")
    ] = False,
    window: Annotated[
        str | None, typer.Option(metavar="ID", help="Write the values of this window; with --csv.")
    ] = None,
    samples: Annotated[
        str | None,
        typer.Option(metavar="LOOP", help="Write the raw samples of this loop; with --csv."),
    ] = None,
    until: Annotated[
        str | None, typer.Option(metavar="TIME", help="With --samples: up to before this time.")
    ] = None,
    csv: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="With --window or --samples: what to write."),
    ] = None,
) -> None:
    """Show verdicts and changes of alarms, the oldest first. It may run beside the agent.

    With --config, where the history goes to a database, that is shown; with --state the agent's file.
    """
    if not trend and (limit is not None or plot is not None):
        raise typer.BadParameter("only with --trend", param_hint="'--limit', '--plot'")
    if (window is None and samples is None) != (csv is None) or (window is not None and samples is not None):
        raise typer.BadParameter("each only with the other", param_hint="'--window' or '--samples', '--csv'")
    if until is not None and samples is None:
        raise typer.BadParameter("only with --samples", param_hint="'--until'")
    start = None if since is None else _time(since, "--since")
    if samples is not None and csv is not None:
        from agent.cli.recalling.samples import write_samples

        with _samples(state, config) as kept:
            write_samples(kept, samples, start, None if until is None else _time(until, "--until"), csv)
        return
    with _store(state, config) as store:
        if window is not None and csv is not None:
            from agent.cli.recalling.windows import write_window

            write_window(store, window, csv)
            return
        if windows:
            from agent.cli.recalling.windows import show_windows

            show_windows(store.windows(loop, start, last), as_json=as_json)
            return
        entries = store.read(loop, start, None if trend else last)
    if trend:
        from agent.cli.trending.trends import show_trends

        show_trends(entries, limit, plot, as_json=as_json)
    elif as_json:
        for entry in entries:
            typer.echo(
                json.dumps({"time": entry.time, "loop": entry.loop, "kind": entry.kind} | entry.content)
            )
    else:
        _show(entries)


def _database(config: Path) -> HistoryDatabase | None:
    from agent.settings import load_settings

    kept = load_settings(config).agent.history
    return None if kept is None else kept.database


@contextmanager
def _store(state: Path | None, config: Path | None) -> Iterator[HistoryFile | PostgresHistory]:
    """Open the database or the agent's file; raises ConfigError where that cannot be done."""
    from agent.runtime.store.history_file import HistoryFile, history_path

    database = None if config is None or state is not None else _database(config)
    if database is None:
        path = history_path(state_file(state, config))
        with opened(path, lambda file: HistoryFile(file, create=False), "with its first verdict") as kept:
            yield kept
        return
    from agent.runtime.store.postgres_history import PostgresHistory

    with _connected(lambda: PostgresHistory(database, create=False), "the newest are") as connected:
        yield connected


@contextmanager
def _samples(state: Path | None, config: Path | None) -> Iterator[PostgresSamples | SampleFile]:
    """Open the raw samples in the database or in the agent's file; raises ConfigError as ``_store``."""
    from agent.runtime.samples.sample_file import SampleFile, samples_path

    database = None if config is None or state is not None else _database(config)
    if database is None:
        path = samples_path(state_file(state, config))
        made = "with its first raw samples (agent.history.database.samples)"
        with opened(path, lambda file: SampleFile(file, create=False), made) as kept:
            yield kept
        return
    from agent.runtime.samples.postgres_samples import PostgresSamples

    with _connected(lambda: PostgresSamples(database, create=False), "what was not sent yet is") as connected:
        yield connected


@contextmanager
def _connected(connect: Callable[[], KeptT], elsewhere: str) -> Iterator[KeptT]:
    """Have a database while it is needed; where it does not answer, the error names what the file has."""
    from agent.runtime.store.database import StoreError
    from connectors.base import ConfigError

    try:
        with closing(connect()) as connected:
            yield connected
    except StoreError as error:
        raise ConfigError([f"{error} ({elsewhere} in the agent's file: --state)"]) from error


def _time(text: str, option: str) -> float:
    """Return s UTC."""
    try:
        time = datetime.fromisoformat(text)
    except ValueError as error:
        raise typer.BadParameter(
            f"{text!r} is not a time like 2026-11-22T06:00", param_hint=f"'{option}'"
        ) from error
    return (time.replace(tzinfo=UTC) if time.tzinfo is None else time).timestamp()


def _show(entries: tuple[Entry, ...]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table("time (UTC)", "loop", "what", "S", "J", "cause, or who", box=None, padding=(0, 2, 0, 0))
    for entry in entries:
        time = f"{datetime.fromtimestamp(entry.time, UTC):%Y-%m-%d %H:%M:%S}"
        if entry.kind == "note":
            action, said = str(entry.content["action"]).replace("_", " "), entry.content["comment"]
            table.add_row(
                time, entry.loop, action, "", "", f"{entry.content['by']}: {said}".removesuffix(": ")
            )
            continue
        is_alarm = entry.kind == "alarm"
        what = f"ALARM {entry.content['state']}" if is_alarm else str(entry.content["verdict"])
        why = entry.content["by"] if is_alarm else entry.content["cause"]
        table.add_row(
            time,
            entry.loop,
            what.replace("_", " "),
            _band(entry.content, "s", is_alarm=is_alarm),
            _band(entry.content, "j", is_alarm=is_alarm),
            str(why or "").replace("_", " "),
            style="bold red" if entry.content.get("active") else None,
        )
    Console().print(table)


def _band(content: dict[str, Any], name: str, *, is_alarm: bool) -> str:
    """Width in OP units; an alarm has plain numbers, a diagnosis has intervals."""
    value = content[name] if is_alarm else content["stiction"][name]["value"]
    return "" if value is None else f"{value:.3g}"
