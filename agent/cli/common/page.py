"""The page beside an agent, for the commands that serve one."""

from __future__ import annotations

import functools
import socket
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from connectors.reuse import listen_again

if TYPE_CHECKING:
    from agent.runtime.agent import Agent
    from agent.settings import HttpSettings


def serve_page(
    agent: Agent,
    settings: HttpSettings,
    say: Callable[[str], None],
    title: str = "slipjump",
    config: Path | None = None,
) -> None:
    """Serve the page, health and metrics while the agent works.

    Args:
        agent: Not running yet.
        settings: Where to listen.
        say: Is given the line with the address when clients can come, once.
        title: Name of the plant.
        config: File that the page may change; None: none.
    """
    from agent.runtime.operate.http import serve
    from agent.runtime.operate.metrics import Metrics
    from agent.runtime.supervisor import Health
    from agent.web.plant import Plant
    from agent.web.plant_page import address, plant_page
    from agent.web.screens import workbench
    from agent.web.screens.answers import csv_of
    from agent.web.workbench.sessions import Sessions

    metrics, health = Metrics(agent.looked), Health(f"http server on {settings.host} port {settings.port}")
    agent.observe(metrics)
    said = False

    def listens() -> None:
        nonlocal said
        health.works()
        if not said:
            said = True
            say(f"address: {address(settings)}")

    def held(loop: str) -> bytes | None:
        pipeline = agent.pipelines.get(loop)
        return None if pipeline is None else csv_of(pipeline).encode()

    sessions = Sessions()
    agent.accompany(Health("workbench"), sessions.run)
    more = [workbench.screen(sessions, held)]
    if config is not None:
        from agent.web.configuration import Configuration
        from agent.web.screens import configure

        more.append(configure.screen(Configuration(config, agent)))
    page = plant_page(Plant(agent), title, more)
    agent.accompany(health, functools.partial(serve, settings, agent, metrics, listens, page))


def free_port(preferred: int) -> int:
    """Return a port of loopback that is free: the preferred one where it is."""
    for port in (preferred, 0):
        with socket.socket() as probe:
            listen_again(probe)
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return int(probe.getsockname()[1])
    raise OSError("no port of 127.0.0.1 is free")
