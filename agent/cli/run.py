"""``slipjump run``: the daemon."""

from __future__ import annotations

import asyncio
import functools
import logging
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common.logs import LogFormat, LogLevel, set_up

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.runtime.agent import Agent
    from agent.settings import HttpSettings, Settings

LOG = logging.getLogger(__name__)


def run(
    config: Annotated[Path, typer.Argument(metavar="CONFIG.yaml", show_default=False)],
    *,
    log_format: Annotated[
        LogFormat, typer.Option(help="Lines for people, or a JSON object each.")
    ] = LogFormat.TEXT,
    log_level: Annotated[LogLevel, typer.Option(help="Lowest severity to log.")] = LogLevel.INFO,
    partition: Annotated[
        str | None, typer.Option(metavar="K/N", help="Watch only part K of N of the loops.")
    ] = None,
    standby: Annotated[
        bool, typer.Option("--standby", help="Wait while another agent has the state file; then take over.")
    ] = False,
) -> None:
    """Watch the loops of a configuration and publish their alarms, until SIGTERM or Ctrl-C.

    SIGHUP reads the configuration again; loops and connections that did not change continue.
    """
    from agent.runtime.capabilities import run_event_loop
    from agent.runtime.operate.heap import keep_one_heap
    from agent.runtime.store.lock import only_agent_of
    from agent.settings import load_settings
    from agent.settings.partition import Partition

    part = None if partition is None else Partition.parse(partition)

    def load(path: Path) -> Settings:
        return load_settings(path) if part is None else part.of_settings(load_settings(path))

    settings = load(config)
    set_up(log_format, log_level)
    keep_one_heap()
    with only_agent_of(settings.agent.state, wait=standby):
        run_event_loop(_until_stopped(config, load(config) if standby else settings, load))


async def _until_stopped(config: Path, settings: Settings, load: Callable[[Path], Settings]) -> None:
    from agent.runtime.agent import Agent
    from agent.runtime.capabilities import on_signals
    from agent.runtime.loop.workers import PoolExecutor
    from agent.runtime.operate import heap
    from agent.runtime.operate.accepting import log_refused_accepts_seldom
    from agent.runtime.operate.notify import ServiceManager
    from agent.runtime.operate.reload import Reloader
    from agent.runtime.operate.watchdog import watch
    from agent.runtime.supervisor import Health

    stopping, changed, manager = asyncio.Event(), asyncio.Event(), ServiceManager.of()
    log_refused_accepts_seldom(asyncio.get_running_loop())
    stop_at = dict.fromkeys(("SIGTERM", "SIGINT", "SIGBREAK"), stopping.set)
    on_signals({**stop_at, "SIGHUP": changed.set})
    async with PoolExecutor(settings.agent.workers) as executor:
        agent = Agent(settings, executor, _log)
        agent.accompany(
            Health("configuration"), Reloader(config, agent, manager, changed, load, heap.settle).run
        )
        agent.accompany(Health("heap"), heap.keep_settled)
        agent.accompany(Health("watchdog"), functools.partial(watch, agent.hung, manager))
        if settings.agent.http is not None:
            _serve_http(agent, settings.agent.http, config)

        def ready() -> None:
            heap.settle()
            LOG.info("%s", agent.summary, extra={"event": "started"})
            manager.ready(agent.summary)

        work = asyncio.create_task(agent.run(ready), name="agent")
        stop = asyncio.create_task(stopping.wait(), name="signals")
        await asyncio.wait({work, stop}, return_when=asyncio.FIRST_COMPLETED)
        manager.stopping()
        work.cancel()
        stop.cancel()
        await asyncio.wait({work, stop})
    LOG.info("stopped", extra={"event": "stopped"})
    if not work.cancelled():
        work.result()  # it never ends by itself: raise what ended it


def _serve_http(agent: Agent, settings: HttpSettings, config: Path) -> None:
    """Serve the page, health and metrics while the agent runs."""
    from agent.cli.common.page import serve_page

    say = functools.partial(print, flush=True)
    serve_page(agent, settings, say, config=config if settings.configure else None)


def _log(diagnosis: Diagnosis) -> None:
    from agent.report.reasons import reasons

    LOG.info(
        "%s: %s. %s",
        diagnosis.loop,
        diagnosis.verdict,
        "; ".join(reasons(diagnosis)),
        extra={"event": "diagnosis", "loop": diagnosis.loop},
    )
