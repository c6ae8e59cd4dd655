"""``slipjump registers``: the register map of a Modbus server of slipjump, to set up the control system."""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from agent.cli.common.columns import aligned
from connectors.base import ConfigError

if TYPE_CHECKING:
    from agent.settings import Settings

HEADER = ("TABLE", "ADDRESS", "TYPE", "LOOP", "ACCESS", "MEANING")


def registers(
    config: Annotated[Path, typer.Argument(metavar="CONFIG.yaml", show_default=False)],
    *,
    connection: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which, where there are several.", show_default=False)
    ] = None,
    as_csv: Annotated[bool, typer.Option("--csv", help="For a spreadsheet or an import.")] = False,
) -> None:
    """Print the register map of a configuration's modbus_server. Addresses are those on the wire, from 0."""
    from agent.settings import load_settings

    rows = [HEADER, *_rows(load_settings(config), connection, config)]
    if as_csv:
        csv.writer(sys.stdout, lineterminator="\n").writerows(rows)
        return
    for line in aligned(rows):
        typer.echo(line)


def _rows(settings: Settings, connection: str | None, config: Path) -> Iterator[tuple[str, ...]]:
    from agent.settings import connectors_of
    from connectors.modbus_server.connector import ModbusServerConnector
    from connectors.modbus_server.register_map import places

    servers = {each.name: each for each in connectors_of(settings) if isinstance(each, ModbusServerConnector)}
    if connection is not None:
        servers = {name: each for name, each in servers.items() if name == connection}
    if len(servers) != 1:
        there = ", ".join(servers) or "none"
        raise ConfigError(
            [f"{config}: expected one modbus_server (there is: {there}); --connection names it"]
        )
    (server,) = servers.values()
    for place in places(server.loops):
        access = "read, write" if place.writable else "read"
        yield place.table, str(place.address), place.type, place.loop, access, place.meaning
