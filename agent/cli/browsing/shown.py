"""What ``slipjump browse`` found: a table, JSON, a configuration."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from agent.cli.common.columns import aligned
from connectors.base import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

    from agent.runtime.commission.found_loops import FoundLoop, LoopSearch

CONNECTION = "dcs"
"""Its name in a configuration that is written."""


def json_lines(found: LoopSearch) -> Iterator[str]:
    """Yield an object for each loop."""
    for loop in found.loops:
        tags = {
            role: {**tag, "value": _plain(loop.values.get(role)), "range": loop.spans.get(role)}
            for role, tag in loop.tags.items()
        }
        yield json.dumps({"loop": loop.name, "names": loop.by, "tags": tags})


def table(found: LoopSearch) -> list[str]:
    """Return a line for each loop, and what was seen."""
    rows = [
        [
            loop.name,
            loop.by,
            *(_shown(loop.values.get(role)) for role in ("pv", "op")),
            *(_place(loop, role) for role in ("pv", "op")),
            " ".join(role for role in loop.tags if role not in ("pv", "op")),
        ]
        for loop in found.loops
    ]
    one = found.called[0].removesuffix("s").upper()
    head = ["LOOP", "NAMES OF", "PV", "OP", f"PV {one}", f"OP {one}", "ALSO"]
    seen = f"{found.nodes} {found.called[0]}, {found.variables} {found.called[1]}, {len(found.loops)} loops"
    return [*(aligned([head, *rows]) if rows else []), "", seen + ended(found)]


def _place(loop: FoundLoop, role: str) -> str:
    """Return where a value is, in few words: a node, or a topic and what distinguishes it there."""
    tag = loop.tags[role]
    if "node" in tag:
        return str(tag["node"])
    where = tag.get("where")
    inside = "#".join(map(str, where.values())) if isinstance(where, dict) else str(tag.get("field", ""))
    return f"{tag['topic']}#{inside}".rstrip("#")


def ended(found: LoopSearch) -> str:
    """Return which bound ended the search, in words; empty where none did."""
    return f" (ended after {found.stopped}, there may be more)" if found.stopped else ""


def write(out: Path, url: str, connection: Mapping[str, object], found: LoopSearch, ts: float) -> None:
    """Write the configuration, which is sure to be one that can be loaded."""
    import yaml

    from agent.settings import settings_of

    loops = [loop.entry(CONNECTION, ts) for loop in found.loops]
    config = {"connections": {CONNECTION: dict(connection)}, "loops": loops}
    settings_of(config)
    head = (
        f"# Loops of {url}, found by slipjump browse on {datetime.now(UTC):%Y-%m-%d}.\n"
        "# Set for each loop: ts, the sampling time, s; acting, reverse or direct; and under publish the\n"
        "# connections for its alarm (docs/configuration.md). Then: slipjump check THIS --connect\n"
    )
    text = yaml.safe_dump(config, sort_keys=False, default_flow_style=None, width=110)
    try:
        with out.open("x", encoding="utf-8") as file:
            file.write(head + text)
    except OSError as error:
        raise ConfigError([f"{out}: cannot be written: {error.strerror}"]) from error


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, int | float) else "-" if value is None else str(value)


def _plain(value: object) -> object:
    return value if isinstance(value, int | str) or (isinstance(value, float) and value == value) else None  # noqa: PLR0124 - NaN
