"""Checks of kinds that read: every value arrives, at its time, with its quality."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping

from connectors.base import LoopRole, Quality
from connectors.checks.peer import LOOPS, ROLES, Peer, PeerFactory
from connectors.checks.proxy import SLICES, FaultProxy
from connectors.checks.session import Kind, Reader, connector_to, expect, require

START = 1_700_000_000.0
"""Time of the first row, s UTC."""
_CLOCK = 1e-5
"""Largest error of a time, s: buses count in units of 100 ns to 1 ms, and START needs 24 bits more."""
Row = Mapping[str, float | str]


def row(k: int, gap: int = 7) -> Row:
    """Return the ``k``-th row; every ``gap``-th has no PV, SP and mode stand still as they mostly do."""
    pv = math.nan if k % gap == gap - 1 else float(k)
    return {"pv": pv, "op": 50.0 + k / 8, "sp": 40.0, "mode": "AUTO"}


async def expect_row(reader: Reader, loop: str, time: float) -> None:
    """Wait until a sample of this time or a later one was read; raises AssertionError."""
    await expect(
        lambda: (reader.seen(loop) or 0.0) >= time - _CLOCK,
        f"{loop}: the row of {time - START:g} s was not read",
    )


async def put_rows(peer: Peer, reader: Reader, first: int, count: int) -> None:
    """Have the peer show rows of every loop, as fast as its ``lead`` allows, until all of them are read.

    Raises:
        AssertionError: a row was not read.
    """

    async def play(loop: str) -> None:
        for k in range(first, first + count):
            await peer.put(loop, START + k, row(k))
            # a bus that keeps only the newest value loses rows that come before somebody subscribes
            if k == first or k - peer.lead > first:
                await expect_row(reader, loop, START + max(first, k - peer.lead))

    await asyncio.gather(*map(play, LOOPS))
    last = START + first + count - 1
    for loop in LOOPS:
        for role in ROLES:
            tag = LoopRole(loop, role)

            def has_last(tag: LoopRole = tag) -> bool:
                return any(abs(sample.time - last) < _CLOCK for sample in reader.of(tag))

            await expect(has_last, f"{tag}: the sample of {last - START:g} s was not read")


def require_rows(peer: Peer, reader: Reader, first: int, count: int) -> None:
    """Require every value of these rows once, at its time and with its quality."""
    for loop in LOOPS:
        for role in ROLES:
            tag = LoopRole(loop, role)
            samples = [each for each in reader.of(tag) if each.time > START + first - 0.5]
            times = [each.time for each in samples]
            wanted = [START + k for k in range(first, first + count)]
            lost = [at - START for at in wanted if not any(abs(at - time) < _CLOCK for time in times)]
            require(not lost, f"{tag}: samples were lost, of these times: {lost[:10]} s")
            require(len(samples) == count, f"{tag}: {len(samples)} samples of {count} rows, some came twice")
            require(times == sorted(times), f"{tag}: samples are not in the order of their times")
            for k, sample in zip(range(first, first + count), samples, strict=True):
                _require_value(f"{tag} at {k} s", sample.value, sample.quality, row(k)[role], peer.precision)


def _require_value(
    place: str, got: float | str, quality: Quality, expected: float | str, precision: float
) -> None:
    if isinstance(expected, str):
        require(got in (expected, 1.0), f"{place}: {got!r}, expected the mode {expected!r} or 1")
    elif math.isnan(expected):
        is_nan = isinstance(got, float) and math.isnan(got)
        require(is_nan and quality is Quality.BAD, f"{place}: {got!r}, {quality.name}, expected NaN, BAD")
        return
    else:
        close = not isinstance(got, str) and abs(got - expected) <= precision * abs(expected)
        require(close, f"{place}: {got!r}, expected {expected!r}")
    require(quality is Quality.GOOD, f"{place}: quality {quality.name}, expected GOOD")


async def every_sample_arrives(kind: Kind, peers: PeerFactory, count: int = 120) -> None:
    """Every value of every loop arrives once, at its time; a missing value is NaN with quality BAD."""
    async with peers() as peer, connector_to(kind, peer).session() as session, Reader(session) as reader:
        await put_rows(peer, reader, 0, count)
        require_rows(peer, reader, 0, count)


async def bytes_may_come_in_pieces(kind: Kind, peers: PeerFactory, count: int = 10) -> None:
    """TCP may cut a message anywhere: the same samples arrive in pieces of 1 to 3 bytes."""
    async with peers() as peer, FaultProxy(peer.port) as proxy, proxy.suffering(SLICES):
        connector = connector_to(kind, peer, proxy.port, wait=10.0)
        async with connector.session() as session, Reader(session) as reader:
            await put_rows(peer, reader, 0, count)
            require_rows(peer, reader, 0, count)
