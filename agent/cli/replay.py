"""``slipjump replay``: recordings through a bus and the agent, as if the plant were there."""

from __future__ import annotations

import asyncio
import json
import re
import sys
import time as wall
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from agent.cli.common import read_options as reading
from agent.cli.common import recordings as option
from agent.cli.common.errors import BAD_INPUT, complain
from agent.cli.common.recordings import Bus
from agent.cli.common.window import window_of

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.cli.common.stage import LivePlay
    from agent.runtime.loop.workers import Executor
    from connectors.recording import ReadOptions, RecordedLoop

RECEIVE = 10.0
"""Longest wait for the last samples to reach the agent, and for an alarm to reach the consumer, s."""
JUDGE = 300.0
"""Longest wait for the diagnosis of a window, s."""
LEAST_WINDOW = 20
"""Samples that a window of the agent has at least."""


@dataclass(frozen=True, slots=True)
class Played:
    """What became of a recording."""

    diagnosis: Diagnosis | None
    """None where no window came about: nothing was known long enough."""
    seen: bool
    """Whether the consumer on the bus received an active alarm."""
    seconds: float


def replay(
    recordings: option.Recordings,
    *,
    bus: Annotated[Bus, typer.Option(help="Bus the recording is played on.")] = Bus.OPCUA,
    speed: Annotated[
        float | None,
        typer.Option(metavar="X", help="Times real time; as fast as the agent reads where not given."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON object a line for each recording.")
    ] = False,
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
    """Play recordings on a bus to the agent, and see on that bus whether it raises an alarm.

    Each recording is one window of the agent, and one window raises the alarm.
    """
    from agent.runtime.capabilities import run_event_loop
    from connectors.recording import Columns

    if speed is not None and not 0 < speed < float("inf"):
        raise typer.BadParameter(f"{speed:g} is not a positive factor", param_hint="'--speed'")
    columns = Columns(time, op, pv, sp, mv, mode, option.positive(ts))
    options = reading.read_options(columns, zone, time_format, date_order, decimal, pattern, mapping, modes)
    paths = option.in_folders(recordings)
    if run_event_loop(_replay_all(paths, options, loop, bus, speed, as_json=as_json)):
        raise typer.Exit(BAD_INPUT)


async def _replay_all(
    paths: list[Path], options: ReadOptions, loop: str | None, bus: Bus, speed: float | None, *, as_json: bool
) -> bool:
    """Play one recording after the other; return whether any failed."""
    from agent.runtime.loop.workers import PoolExecutor
    from connectors.base import ConfigError
    from connectors.recording import read_recording

    failed = False
    async with PoolExecutor(1) as executor:
        for path in paths:
            try:
                recording = read_recording(path, options.columns, options, loop)
                played = await _play(recording, bus, speed, executor)
            except ConfigError as error:
                failed = True
                for fault in error.faults:
                    complain(fault)
            except OSError as error:
                failed = True
                complain(str(error))
            else:
                _say(recording, bus, played, as_json=as_json)
    return failed


async def _play(recording: RecordedLoop, bus: Bus, speed: float | None, executor: Executor) -> Played:
    from dataclasses import replace

    from agent.analysis.record.recording import LoopHints
    from agent.cli.common.stage import on_stage, until
    from simulators.source import RecordingSource

    started = wall.monotonic()
    whole = window_of(recording, LoopHints())
    known = whole.valid.nonzero()[0]
    if len(known) == 0 or len(whole) - known[0] < LEAST_WINDOW:
        return Played(None, seen=False, seconds=wall.monotonic() - started)
    loop = re.sub(r"[\s/+#.]", "_", recording.name)
    source = RecordingSource(replace(recording, name=loop))
    options: Mapping[str, Any] = {
        "window": {"seconds": (len(whole) - int(known[0])) * whole.ts, "hop": 1.0},
        "alarm": {"on_delay": 1, "off_delay": 1},
        "quantify": "always",
    }
    diagnoses: list[Diagnosis] = []
    async with on_stage({bus.value: [source]}, lambda _: options, speed, executor, diagnoses.append) as stage:
        await _with_progress(stage, loop, recording)
        await until(lambda: bool(diagnoses) or stage.agent.busy(loop), RECEIVE)
        await until(lambda: bool(diagnoses) or not stage.agent.busy(loop), JUDGE)
        sticks = bool(diagnoses) and diagnoses[-1].verdict == "stiction"
        seen = sticks and await until(lambda: stage.told.get(loop, False), RECEIVE)
        seen = seen or stage.told.get(loop, False)
    return Played(diagnoses[-1] if diagnoses else None, seen, wall.monotonic() - started)


async def _with_progress(stage: LivePlay, loop: str, recording: RecordedLoop) -> None:
    """Wait until all is played, with a bar on a terminal's stderr."""
    from rich.console import Console
    from rich.progress import Progress

    start, end = float(recording.time[0]), float(recording.time[-1])
    with Progress(console=Console(stderr=True), disable=not sys.stderr.isatty(), transient=True) as progress:
        bar = progress.add_task(f"playing {recording.name}", total=end - start)
        while not stage.playing.done():
            progress.update(bar, completed=(stage.agent.newest(loop) or start) - start)
            await asyncio.wait({stage.playing}, timeout=0.2)
    await stage.playing


def _say(recording: RecordedLoop, bus: Bus, played: Played, *, as_json: bool) -> None:
    from agent.report.diagnosis_json import stiction_json
    from agent.report.reasons import reasons

    diagnosis = played.diagnosis
    verdict = diagnosis.verdict if diagnosis else "not_testable"
    if as_json:
        found = diagnosis.quantification if diagnosis else None
        answer = {
            "recording": recording.path.name,
            "loop": recording.name,
            "bus": bus.value,
            "verdict": verdict,
            "alarm_seen_on_bus": played.seen,
            "stiction": stiction_json(found.stiction if found else None),
            "seconds": round(played.seconds, 2),
        }
        text = json.dumps(answer, allow_nan=False)
    else:
        alarm = "alarm seen" if played.seen else "no alarm"
        words = reasons(diagnosis) if diagnosis else ("no stretch in which OP and PV are both known",)
        text = "\n  - ".join(
            [f"{recording.name}: {verdict.replace('_', ' ')}, {alarm} on {bus.value}", *words]
        )
    print(text, flush=True)  # noqa: T201 - this is the command's output
