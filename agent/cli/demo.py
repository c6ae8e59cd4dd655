"""``slipjump demo``: a simulated plant on three buses, the agent beside it, and consumers of its alarms."""

from __future__ import annotations

import asyncio
import functools
import json
import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from agent.analysis.diagnosis import Diagnosis
    from agent.cli.common.stage import LivePlay
    from agent.runtime.agent import Agent
    from agent.runtime.operate.status import LoopStatus
    from simulators.scenario import Scenario


LONG = 1e8
"""Duration of the scenarios, simulated s: weeks at 60 times real time, on however slow a machine."""
REAL_TIME = 1.0
"""Speed after all verdicts are in: a page that stays open costs little."""
INCOMPLETE = 1
"""Exit code where verdicts are missing."""
PORT = 9187
"""Of the page, where it is free: the one of `agent.http`."""


@dataclass(slots=True)
class DemoLoop:
    """One loop of the demo and what became of it."""

    scenario: Scenario
    bus: str
    diagnoses: list[Diagnosis] = field(default_factory=list)
    active: bool = False
    """Whether the agent holds its alarm active."""
    seen: bool = False
    """Whether the consumer on its bus received it."""
    missing: str | None = None
    """What was missing at the end."""

    @property
    def name(self) -> str:
        """Tag of the loop."""
        return self.scenario.loop

    @property
    def verdict(self) -> str:
        """Verdict of the newest window; undecided before the first."""
        return self.diagnoses[-1].verdict if self.diagnoses else "undecided"

    def lacks(self, windows: int) -> str | None:
        """Return what is missing until the last ``windows`` firm verdicts agree and the bus has what follows.

        An undecided window says nothing against them, as it neither raises nor clears an alarm.
        """
        from agent.analysis.results import FIRM

        if not self.diagnoses:
            return "no verdict yet"
        if self.verdict not in FIRM:
            return f"its newest verdict is {self.verdict.replace('_', ' ')}"
        firm = [each.verdict for each in self.diagnoses if each.verdict in FIRM][-windows:]
        if len(firm) < windows or len(set(firm)) > 1:
            return f"no {windows} firm verdicts in a row that agree"
        if self.seen != (self.verdict == "stiction"):
            return f"its alarm was {'' if self.seen else 'not '}seen on {self.bus}"
        return None


def demo(
    *,
    seconds: Annotated[
        float, typer.Option(min=1.0, help="Longest wall time, s; it ends as soon as all verdicts are in.")
    ] = 600.0,
    no_web: Annotated[bool, typer.Option("--no-web", help="Without the page.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object at the end.")] = False,
) -> None:
    """Show the main job: simulated loops stream in over three buses, sticking valves raise alarms there.

    It takes about a minute. Where a verdict is missing after --seconds it says so and ends with exit code 1.
    """
    from rich.console import Console

    from agent.cli.common.errors import BAD_INPUT, complain
    from agent.runtime.capabilities import run_event_loop

    console = Console(stderr=as_json)
    try:
        loops, elapsed = run_event_loop(_play(seconds, console, web=not no_web, stays=not as_json))
    except OSError as error:
        complain(str(error))
        raise typer.Exit(BAD_INPUT) from error
    missing = [f"{loop.name}: {loop.missing}" for loop in loops if loop.missing is not None]
    for line in missing:
        complain(line)
    if missing:
        complain(f"ended after {elapsed:.0f} s with verdicts missing: give it longer (--seconds)")
    elif not as_json and not console.is_terminal:
        console.print(f"all verdicts are in, after {elapsed:.0f} s", highlight=False)
    if as_json:
        rows = [
            {
                "loop": loop.name,
                "bus": loop.bus,
                "truth": loop.scenario.truth.verdict,
                "verdict": loop.verdict,
                "alarm": "active" if loop.active else "normal",
                "alarm_seen_on_bus": loop.seen,
            }
            for loop in loops
        ]
        print(json.dumps({"loops": rows, "seconds": round(elapsed, 1)}))  # noqa: T201 - the command's output
    if missing:
        raise typer.Exit(INCOMPLETE)


async def _play(seconds: float, console: Console, *, web: bool, stays: bool) -> tuple[list[DemoLoop], float]:
    """Play until all verdicts are in, at most so many seconds; return the loops and the wall time.

    With ``web`` the page is served, and on a terminal, where it ``stays``, until Ctrl-C.
    """
    import yaml

    from agent.cli.common.config_folder import config_folder
    from agent.cli.common.page import free_port, serve_page
    from agent.cli.common.stage import on_stage
    from agent.runtime.capabilities import on_signals
    from agent.runtime.loop.workers import PoolExecutor
    from agent.settings import HttpSettings
    from simulators.source import PlantSource

    folder = config_folder()
    plan = yaml.safe_load((folder / "demo.yaml").read_text(encoding="utf-8"))
    stays = web and stays and console.is_terminal
    loops = _loops(folder / "scenarios", plan["loops"])
    by_name = {loop.name: loop for loop in loops}
    sources = defaultdict(list)
    for loop in loops:
        sources[loop.bus].append(PlantSource(loop.scenario))
    windows = plan["alarm"]["on_delay"]
    console.print(f"{len(loops)} loops on {', '.join(sources)}, {plan['speed']} times real time")
    # Not behind others: somebody waits for the verdicts, and simulated samples wait for them.
    async with PoolExecutor(plan["workers"], behind=0) as executor:

        def accompany(agent: Agent) -> None:
            if web:
                say = functools.partial(console.print, highlight=False, soft_wrap=True)
                serve_page(agent, HttpSettings(port=free_port(PORT)), say, "Demo plant")

        async with on_stage(
            sources,
            lambda source: {"window": plan["window"], "alarm": plan["alarm"], **_known(by_name[source.loop])},
            plan["speed"],
            executor,
            lambda diagnosis: by_name[diagnosis.loop].diagnoses.append(diagnosis),
            accompany,
        ) as stage:
            elapsed = await _watch(loops, stage, console, windows, seconds)
            if stays and all(loop.missing is None for loop in loops):
                console.print("All verdicts are in. The plant goes on in real time, the page until Ctrl-C.")
                for clock in stage.clocks:
                    clock.change(REAL_TIME)
                end = asyncio.Event()
                on_signals({"SIGINT": end.set})
                await end.wait()
    return loops, elapsed


async def _watch(
    loops: list[DemoLoop], stage: LivePlay, console: Console, windows: int, seconds: float
) -> float:
    """Show a table until all verdicts are in, at most so many seconds; return the wall time, s."""
    from rich.live import Live

    from agent.cli.common.stage import LOOK

    started = time.monotonic()
    with Live(_table(loops, stage), console=console, auto_refresh=False) as live:
        while time.monotonic() - started < seconds and any(loop.lacks(windows) for loop in loops):
            await asyncio.sleep(10 * LOOK)
            for loop, status in zip(loops, _status(loops, stage), strict=True):
                loop.active, loop.seen = status.alarm.active, stage.told.get(loop.name, False)
            live.update(_table(loops, stage), refresh=console.is_terminal)
    if not console.is_terminal:
        console.print()  # the table that a pipe gets at the end has no end of line
    for loop in loops:
        loop.missing = loop.lacks(windows)
    return time.monotonic() - started


def _loops(folder: Path, entries: Sequence[Mapping[str, str]]) -> list[DemoLoop]:
    """Return the loops of the plan; none ends by itself."""
    from simulators.scenario import load_scenario

    return [
        DemoLoop(
            load_scenario(folder / Path(entry["scenario"])).model_copy(update={"duration": LONG}),
            entry["bus"],
        )
        for entry in entries
    ]


def _status(loops: list[DemoLoop], stage: LivePlay) -> list[LoopStatus]:
    """Return what the agent knows of each loop, in their order."""
    status = {status.loop: status for status in stage.agent.status()}
    return [status[loop.name] for loop in loops]


def _known(loop: DemoLoop) -> dict[str, Any]:
    """Return what an engineer would write into the configuration of this loop."""
    return {"acting": loop.scenario.controller.acting, "op_range": list(loop.scenario.op_range)}


def _table(loops: list[DemoLoop], stage: LivePlay) -> Table:
    """Return the plant as it stands, a row a loop."""
    from rich.table import Table

    columns = ("loop", "bus", "samples", "period", "truth", "verdict", "S (true)", "on bus")
    table = Table(*columns, box=None, padding=(0, 2, 0, 0))
    for loop, now in zip(loops, _status(loops, stage), strict=True):
        valve = loop.scenario.valve
        found = loop.diagnoses[-1] if loop.diagnoses else None
        seen = found.oscillation if found else None
        fit = found.quantification if found and found.verdict == "stiction" else None
        band = fit.stiction if fit else None
        table.add_row(
            loop.name,
            loop.bus,
            str(now.samples),
            f"{seen.period:.0f} s" if seen and seen.detected and seen.period else "",
            loop.scenario.truth.verdict.replace("_", " "),
            loop.verdict.replace("_", " ") if found else "...",
            f"{band.s.value:.2f} ({valve.f_s + valve.f_d:.2f})" if band else "",
            "ALARM" if loop.seen else "",
            style="bold red" if loop.seen else None,
        )
    return table
