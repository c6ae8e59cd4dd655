"""The YAML file as models; reports every fault at once, each with its path."""

from agent.settings.load import connectors_of, load_settings, settings_of, tags_on
from agent.settings.models import (
    AgentSettings,
    AlarmSettings,
    ConnectionSettings,
    LoopSettings,
    Settings,
    WindowSettings,
)
from agent.settings.service import HistoryDatabase, HistorySettings, HttpSettings, SampleSettings

__all__ = [
    "AgentSettings",
    "AlarmSettings",
    "ConnectionSettings",
    "HistoryDatabase",
    "HistorySettings",
    "HttpSettings",
    "LoopSettings",
    "SampleSettings",
    "Settings",
    "WindowSettings",
    "connectors_of",
    "load_settings",
    "settings_of",
    "tags_on",
]
