"""The page of a running agent, as a server takes it."""

from __future__ import annotations

from collections.abc import Sequence

from starlette.applications import Starlette
from starlette.types import ASGIApp

from agent.runtime.operate.http import PageOf
from agent.settings import HttpSettings
from agent.web.access import LOOPBACK, Access
from agent.web.app import application
from agent.web.plant import Plant
from agent.web.screens import alarms, loop, system, work_list
from agent.web.screens.screen import PageScreen


def plant_page(plant: Plant, title: str = "slipjump", more: Sequence[PageScreen] = ()) -> PageOf:
    """Return what builds the page around the routes of monitoring.

    Args:
        plant: What it shows.
        title: Name of the plant.
        more: Further screens, after those of the plant.
    """
    screens = [each.screen(plant) for each in (work_list, loop, alarms, system)] + list(more)

    def built(monitoring: Starlette, settings: HttpSettings, token: str | None) -> ASGIApp:
        hosts = LOOPBACK | {settings.host} if settings.is_loopback else None
        return application(screens, Access(token, hosts), monitoring.routes, title)

    return built


def address(settings: HttpSettings) -> str:
    """Return where a browser on this machine finds the page."""
    host = "127.0.0.1" if settings.host in ("0.0.0.0", "::") else settings.host  # noqa: S104 - compared only
    return f"http://{f'[{host}]' if ':' in host else host}:{settings.port}/"
