"""Raw samples of one loop as a recording."""

from __future__ import annotations

import csv
import math
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from agent.cli.recalling.windows import NAMES, cell

if TYPE_CHECKING:
    from pathlib import Path

    from agent.runtime.samples.recalled import Samples


def write_samples(samples: Samples, loop: str, since: float | None, until: float | None, path: Path) -> None:
    """Write what came of a loop from ``since`` to before ``until`` (s UTC) as CSV that every command reads.

    Raises:
        ConfigError: Nothing came, or the file cannot be written.
    """
    from agent.runtime.samples.recalled import roles_of, rows_of
    from connectors.base import ConfigError

    span = -math.inf if since is None else since, math.inf if until is None else until
    roles = roles_of(samples, loop, *span)
    if not roles:
        raise ConfigError([f"no raw samples of {loop} are kept of this time"])
    numbers = [role for role in roles if role in NAMES]
    try:
        with path.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file)
            table.writerow(["time", *(NAMES[role] for role in numbers), *(["mode"] * ("mode" in roles))])
            for row in rows_of(samples, loop, *span):
                time = datetime.fromtimestamp(row.time, UTC).isoformat()
                cells = [cell(row.values.get(role, math.nan)) for role in numbers]
                table.writerow([time, *cells, *([row.mode] * ("mode" in roles))])
    except OSError as error:
        raise ConfigError([f"{path}: {error.strerror}"]) from error
