"""``slipjump check``: is the configuration right, and is the plant there?"""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.errors import BAD_INPUT

if TYPE_CHECKING:
    from agent.runtime.probe import Finding
    from agent.settings import LoopSettings, Settings


def check(
    config: Annotated[Path, typer.Argument(metavar="CONFIG.yaml", show_default=False)],
    *,
    connect: Annotated[
        bool, typer.Option("--connect", help="Open each connection and read one value of every tag.")
    ] = False,
    within: Annotated[
        float, typer.Option(min=0.1, max=3600, metavar="SECONDS", help="How long --connect waits.")
    ] = 10.0,
) -> None:
    """Say what run would do with a configuration, or everything that is wrong with it."""
    from agent.settings import load_settings

    settings = load_settings(config)
    for line in _plan(settings):
        typer.echo(line)
    if not connect:
        return
    from agent.runtime.probe import probe

    findings = asyncio.run(probe(settings, within))
    for finding in findings:
        typer.echo(_told(finding))
    if any(finding.problem for finding in findings):
        sys.exit(BAD_INPUT)


def _plan(settings: Settings) -> list[str]:
    lines = [f"{name}: {entry.kind}, {entry.options}" for name, entry in settings.connections.items()]
    return [*lines, *(_loop(loop) for loop in settings.loops)]


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


def _told(finding: Finding) -> str:
    subject = finding.tag or finding.connection
    if finding.problem is not None:
        return f"{subject}: {finding.problem}"
    if finding.sample is None:
        return f"{subject}: is there"
    return f"{subject}: {finding.sample.value} ({finding.sample.quality.name.lower()})"
