"""``slipjump run``: the daemon."""

from __future__ import annotations

import asyncio
import logging
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from agent.analysis.results import Diagnosis
    from agent.settings import Settings

LOG = logging.getLogger(__name__)


def run(config: Annotated[Path, typer.Argument(metavar="CONFIG.yaml", show_default=False)]) -> None:
    """Watch the loops of a configuration and publish their alarms, until SIGTERM or Ctrl-C."""
    from agent.settings import load_settings

    settings = load_settings(config)
    logging.basicConfig(format="%(asctime)s %(levelname)s %(message)s", level=logging.INFO)
    for library in ("asyncua", "pymodbus", "aiomqtt", "mqtt"):
        logging.getLogger(library).setLevel(logging.CRITICAL)  # what they lose the supervisor tells, once
    asyncio.run(_until_told(settings))


async def _until_told(settings: Settings) -> None:
    from agent.runtime.agent import Agent
    from agent.runtime.workers import PoolExecutor

    told = asyncio.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, told.set)
    async with PoolExecutor(settings.agent.workers) as executor:
        work = asyncio.create_task(Agent(settings, executor, _log).run(), name="agent")
        stop = asyncio.create_task(told.wait(), name="signals")
        LOG.info("watching %d loops on %d connections", len(settings.loops), len(settings.connections))
        await asyncio.wait({work, stop}, return_when=asyncio.FIRST_COMPLETED)
        work.cancel()
        stop.cancel()
        await asyncio.wait({work, stop})
    LOG.info("stopped")
    if not work.cancelled():
        work.result()  # it never ends by itself: raise what ended it


def _log(diagnosis: Diagnosis) -> None:
    LOG.info("%s: %s. %s", diagnosis.loop, diagnosis.verdict, "; ".join(diagnosis.reasons))
