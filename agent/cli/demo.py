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
    from agent.cli.common.stage import Stage
    from agent.runtime.agent import Agent
    from agent.runtime.operate.status import LoopStatus
    from simulators.scenario import Scenario


LONG = 1e8
"""Duration of the scenarios where somebody looks at the page, simulated s: a month at 40 times real time."""
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
    """Whether the consumer on its bus was told so."""

    @property
    def name(self) -> str:
        """Tag of the loop."""
        return self.scenario.loop

    @property
    def verdict(self) -> str:
        """Verdict of the newest window; undecided before the first."""
        return self.diagnoses[-1].verdict if self.diagnoses else "undecided"

    def settled(self, windows: int) -> bool:
        """Whether ``windows`` verdicts in a row agree, and the bus has what follows from them."""
        last = [diagnosis.verdict for diagnosis in self.diagnoses[-windows:]]
        agreed = len(last) == windows and len(set(last)) == 1
        return agreed and self.seen == (last[0] == "stiction")


def demo(
    *,
    seconds: Annotated[
        float, typer.Option(min=1.0, help="Longest wall time; it ends when all verdicts are in.")
    ] = 120.0,
    no_web: Annotated[bool, typer.Option("--no-web", help="Without the page.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object at the end.")] = False,
) -> None:
    """Show the main job: simulated loops stream in over three buses, sticking valves raise alarms there."""
    from rich.console import Console

    from agent.cli.common.errors import BAD_INPUT, complain
    from agent.runtime.capabilities import run_event_loop

    console = Console(stderr=as_json)
    try:
        loops, elapsed = run_event_loop(_play(seconds, console, web=not no_web, stays=not as_json))
    except OSError as error:
        complain(str(error))
        raise typer.Exit(BAD_INPUT) from error
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


async def _play(seconds: float, console: Console, *, web: bool, stays: bool) -> tuple[list[DemoLoop], float]:
    """Play until all verdicts are in, at most so many seconds; return the loops and the wall time.

    With ``web`` the page is served, and on a terminal, where it ``stays``, until Ctrl-C.
    """
    import yaml
    from rich.live import Live

    from agent.cli.common.config_folder import config_folder
    from agent.cli.common.page import free_port, serve_page
    from agent.cli.common.stage import LOOK, on_stage
    from agent.runtime.capabilities import on_signals
    from agent.runtime.loop.workers import PoolExecutor
    from agent.settings import HttpSettings
    from simulators.source import PlantSource

    folder = config_folder()
    plan = yaml.safe_load((folder / "demo.yaml").read_text(encoding="utf-8"))
    stays = web and stays and console.is_terminal
    loops = _loops(folder / "scenarios", plan["loops"], LONG if stays else None)
    by_name = {loop.name: loop for loop in loops}
    sources = defaultdict(list)
    for loop in loops:
        sources[loop.bus].append(PlantSource(loop.scenario))
    windows = plan["alarm"]["on_delay"]
    console.print(f"{len(loops)} loops on {', '.join(sources)}, {plan['speed']} times real time")
    async with PoolExecutor(plan["workers"]) as executor:
        started = time.monotonic()

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
            with Live(_table(loops, stage), console=console, auto_refresh=False) as live:

                async def look_again() -> None:
                    await asyncio.sleep(10 * LOOK)
                    for loop, status in zip(loops, _status(loops, stage), strict=True):
                        loop.active, loop.seen = status.alarm.active, stage.told.get(loop.name, False)
                    live.update(_table(loops, stage), refresh=console.is_terminal)

                while time.monotonic() - started < seconds and not all(
                    loop.settled(windows) for loop in loops
                ):
                    await look_again()
                elapsed = time.monotonic() - started
                if stays:
                    console.print("All verdicts are in. The page stays until Ctrl-C.")
                    end = asyncio.Event()
                    on_signals({"SIGINT": end.set})
                    while not end.is_set():
                        await look_again()
    return loops, elapsed


def _loops(folder: Path, entries: Sequence[Mapping[str, str]], duration: float | None) -> list[DemoLoop]:
    """Return the loops of the plan, each with its own duration or another (s)."""
    from simulators.scenario import load_scenario

    scenarios = [load_scenario(folder / Path(entry["scenario"])) for entry in entries]
    if duration is not None:
        scenarios = [each.model_copy(update={"duration": duration}) for each in scenarios]
    return [DemoLoop(each, entry["bus"]) for each, entry in zip(scenarios, entries, strict=True)]


def _status(loops: list[DemoLoop], stage: Stage) -> list[LoopStatus]:
    """Return what the agent knows of each loop, in their order."""
    status = {status.loop: status for status in stage.agent.status()}
    return [status[loop.name] for loop in loops]


def _known(loop: DemoLoop) -> dict[str, Any]:
    """Return what an engineer would write into the configuration of this loop."""
    return {"acting": loop.scenario.controller.acting, "op_range": list(loop.scenario.op_range)}


def _table(loops: list[DemoLoop], stage: Stage) -> Table:
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
