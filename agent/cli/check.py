"""``slipjump check``: is the configuration right, and is the plant there?"""

from __future__ import annotations

import json
import logging
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common.columns import aligned
from agent.cli.common.errors import BAD_INPUT, complain
from agent.counted import counted
from agent.durations import duration_words

if TYPE_CHECKING:
    from agent.runtime.commission.probe import Finding
    from agent.settings import LoopSettings, Settings


def check(
    config: Annotated[Path, typer.Argument(metavar="CONFIG.yaml", show_default=False)],
    *,
    connect: Annotated[
        bool, typer.Option("--connect", help="Open each connection, read every tag, look at every target.")
    ] = False,
    within: Annotated[
        float, typer.Option(min=0.1, max=3600, metavar="SECONDS", help="How long --connect waits for values.")
    ] = 10.0,
    watch: Annotated[
        float,
        typer.Option(min=0, max=3600, metavar="SECONDS", help="Further time to see which values change."),
    ] = 5.0,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line.")] = False,
) -> None:
    """Print what run would do with a configuration, or all its faults. Writes nothing."""
    from agent.settings import load_settings

    settings = load_settings(config)
    _warn(config, settings, as_json=as_json)
    if not connect:
        for line in _plan_json(settings) if as_json else _plan(settings):
            typer.echo(line)
        return
    findings = _probed(settings, within, watch)
    for line in map(_json, findings) if as_json else _report(settings, findings):
        typer.echo(line)
    if any(finding.problems for finding in findings):
        sys.exit(BAD_INPUT)


def _warn(config: Path, settings: Settings, *, as_json: bool) -> None:
    """Name the loops that read PV and OP from one place; not an error, for a person may want it."""
    from agent.settings.places import Places
    from agent.settings.same_tags import same_tags

    places = Places.of(config.read_text(encoding="utf-8"))
    connections = {loop.name: loop.connection for loop in settings.loops}
    for loop, words in same_tags(settings).items():
        if as_json:
            where_read = {"connection": connections[loop], "loop": loop, "place": "pv, op"}
            typer.echo(json.dumps({"what": "warning", **where_read, "problems": [], "remarks": [words]}))
            continue
        line = places.line("loops", loop, "tags")
        where = str(config) if line is None else f"{config}, line {line}"
        complain(f"{where}: loop {loop}: warning: {words}")


def _probed(settings: Settings, within: float, watch: float) -> tuple[Finding, ...]:
    from rich.console import Console

    from agent.runtime.capabilities import run_event_loop
    from agent.runtime.commission.probe import probe

    logging.getLogger("connectors").setLevel(logging.CRITICAL)  # the report shows it, with loop and tag
    tags = sum(len(loop.roles) for loop in settings.loops)
    console = Console(stderr=True)
    if not console.is_terminal:
        return run_event_loop(probe(settings, within, watch))
    with console.status(f"reading {tags} tags on {len(settings.connections)} connections"):
        return run_event_loop(probe(settings, within, watch))


def _plan(settings: Settings) -> list[str]:
    lines = [f"{name}: {entry.kind}, {entry.options}" for name, entry in settings.connections.items()]
    return [*lines, *(_loop(loop) for loop in settings.loops)]


def _plan_json(settings: Settings) -> list[str]:
    connections = [
        {"what": "connection", "connection": name, "kind": entry.kind}
        for name, entry in settings.connections.items()
    ]
    loops = [
        {
            "what": "loop",
            "loop": loop.name,
            "connection": loop.connection,
            "ts": loop.ts,
            "roles": loop.roles,
            "publish": [target.connection for target in loop.publish],
        }
        for loop in settings.loops
    ]
    return [json.dumps(each) for each in (*connections, *loops)]


def _loop(loop: LoopSettings) -> str:
    window, targets = loop.window, sorted({target.connection for target in loop.publish})
    length = (
        f"{window.periods:g} periods, {window.shortest:g} to {window.longest:g} s"
        if window.seconds is None
        else f"{window.seconds:g} s"
    )
    alarm = f"alarm to {', '.join(targets)}" if targets else "no alarm is published"
    read = f"{', '.join(loop.roles)} from {loop.connection} every {loop.ts:g} s"
    return f"{loop.name}: {read}, windows of {length}, {alarm}"


def _report(settings: Settings, findings: Sequence[Finding]) -> list[str]:
    """Return a line for each connection, a table of tags, one of targets, and a summary."""
    connections = [
        f"{each.connection} ({settings.connections[each.connection].kind}): {_says(each) or 'is there'}"
        for each in findings
        if each.what == "connection"
    ]
    tags = [_tag_row(each) for each in findings if each.what == "tag"]
    targets = [
        [each.loop, each.connection, each.place, _says(each) or "ok"]
        for each in findings
        if each.what == "target"
    ]
    lines = connections
    if tags:
        lines += ["", *aligned([["LOOP", "TAG", "VALUE", "QUALITY", "AGE", ""], *tags])]
    if targets:
        lines += ["", *aligned([["LOOP", "PUBLISHES", "PLACE", ""], *targets])]
    bad = sum(bool(each.problems) for each in findings)
    doubtful = sum(bool(each.remarks) for each in findings)
    size = f"{counted(len(tags), 'tag')}, {counted(len(targets), 'target')}"
    return [
        *lines,
        "",
        f"{size}: {bad} with a problem, {doubtful} to look at",
    ]


def _tag_row(finding: Finding) -> list[str]:
    reading = finding.reading
    if reading is None:
        return [finding.loop, finding.place, "", "", "", _says(finding)]
    value = reading.sample.value
    shown = value if isinstance(value, str) else "" if math.isnan(value) else f"{value:.6g}"
    late = round(reading.age, 1)
    age = f"-{duration_words(-late)}" if late < 0 else duration_words(abs(late))
    return [
        finding.loop,
        finding.place,
        shown,
        reading.sample.quality.name.lower(),
        age,
        _says(finding) or "ok",
    ]


def _says(finding: Finding) -> str:
    return "; ".join((*finding.problems, *finding.remarks))


def _json(finding: Finding) -> str:
    fields: dict[str, object] = {"what": finding.what, "connection": finding.connection}
    if finding.what != "connection":
        fields |= {"loop": finding.loop, "role" if finding.what == "tag" else "place": finding.place}
    if finding.what == "tag":
        reading = finding.reading
        value = None if reading is None else reading.sample.value
        fields |= {
            "value": None if isinstance(value, float) and not math.isfinite(value) else value,
            "quality": None if reading is None else reading.sample.quality.name.lower(),
            "code": None if reading is None else reading.sample.code,
            "age_s": None if reading is None else round(reading.age, 3),
        }
    return json.dumps(fields | {"problems": finding.problems, "remarks": finding.remarks})
