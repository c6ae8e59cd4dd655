"""Agents beside peers of other makers, which the tests' own peers are not."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence

from benchmarks.cases.options import Options
from benchmarks.peers.installed import PeerMissingError, modbus_program, node_program
from benchmarks.peers.scenes import Step, aedes, libmodbus, node_opcua
from benchmarks.tables.markdown import table

Scene = Callable[[Sequence[str]], AsyncIterator[Step]]
PEERS: dict[str, tuple[Callable[[], list[str]], Scene]] = {
    "aedes": (lambda: node_program("aedes", "aedes_broker.mjs"), aedes),
    "node-opcua": (lambda: node_program("node-opcua", "node_opcua_server.js"), node_opcua),
    "libmodbus": (modbus_program, libmodbus),
}


def run(_options: Options) -> None:
    """Print a row for each thing that must hold; a peer that cannot be had is skipped with a line."""
    lines: list[tuple[str, str, str]] = []
    for name, (install, scene) in PEERS.items():
        try:
            command = install()
        except PeerMissingError as error:
            lines.append((name, f"skipped: {error}", "-"))
            continue
        lines += [(name, *step) for step in asyncio.run(_steps(scene, command))]
    print(table("### Peers of other makers", ("peer", "what held", "after s"), lines))


async def _steps(scene: Scene, command: Sequence[str]) -> list[tuple[str, str]]:
    """Return what held until something did not, and that."""
    steps: list[tuple[str, str]] = []
    try:
        async for what, seconds in scene(command):
            steps.append((what, f"{seconds:.1f}"))
    except (TimeoutError, RuntimeError) as error:
        steps.append((f"**then it did not go on**: {error or 'not in time'}", "-"))
    return steps
