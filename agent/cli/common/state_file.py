"""What the commands share that read an agent's files: the options that name them, and how one is opened."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Annotated, Protocol, TypeVar

import typer

StatePath = Annotated[
    Path | None, typer.Option("--state", metavar="FILE.sqlite", help="The agent's file (agent.state).")
]
ConfigPath = Annotated[
    Path | None, typer.Option("--config", metavar="CONFIG.yaml", help="Its configuration, which names it.")
]


class _File(Protocol):
    def close(self) -> None: ...


FileT = TypeVar("FileT", bound=_File)


def state_file(state: Path | None, config: Path | None) -> Path:
    """Return the agent's file; raises ConfigError where neither option names it."""
    from agent.settings import load_settings
    from connectors.base import ConfigError

    if config is not None and state is None:
        state = load_settings(config).agent.state
    if state is None:
        raise ConfigError(["name the agent's file by --state FILE.sqlite or --config CONFIG.yaml"])
    return state


@contextmanager
def opened(path: Path, open_file: Callable[[Path], FileT], made: str) -> Iterator[FileT]:
    """Open a file that an agent keeps, and close it; raises ConfigError where it is not there or of no use.

    Args:
        path: Of the file.
        open_file: Opens one that is there.
        made: When an agent makes it, in words.
    """
    from agent.runtime.store.database import StoreError
    from connectors.base import ConfigError

    if not path.is_file():
        raise ConfigError([f"{path}: is not there; an agent makes it {made}"])
    try:
        with closing(open_file(path)) as file:
            yield file
    except StoreError as error:
        raise ConfigError([str(error)]) from error
