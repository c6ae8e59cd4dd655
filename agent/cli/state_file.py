"""Options of the commands that read what an agent keeps."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

StatePath = Annotated[
    Path | None, typer.Option("--state", metavar="FILE.sqlite", help="The agent's file (agent.state).")
]
ConfigPath = Annotated[
    Path | None, typer.Option("--config", metavar="CONFIG.yaml", help="Its configuration, which names it.")
]


def state_file(state: Path | None, config: Path | None) -> Path:
    """Return the agent's file; raises ConfigError where neither option names it."""
    from agent.settings import load_settings
    from connectors.base import ConfigError

    if config is not None and state is None:
        state = load_settings(config).agent.state
    if state is None:
        raise ConfigError(["name the agent's file by --state FILE.sqlite or --config CONFIG.yaml"])
    return state
