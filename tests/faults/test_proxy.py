"""The proxy does what its faults say, and nothing else."""

import asyncio
import contextlib
import time

import pytest

from connectors.checks import proxy as faults
from connectors.checks.proxy import FaultProxy

ANSWER = bytes(range(256)) * 4


@pytest.fixture
async def echo():
    """Port of a server that says ANSWER to each byte."""
    open_writers = []

    async def serve(reader, writer):
        open_writers.append(writer)
        with contextlib.suppress(OSError):
            while await reader.read(1):
                writer.write(ANSWER)
        writer.close()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    yield server.sockets[0].getsockname()[1]
    server.close()
    for writer in open_writers:
        writer.close()
        with contextlib.suppress(OSError):
            await writer.wait_closed()


@contextlib.asynccontextmanager
async def client(proxy):
    reader, writer = await asyncio.open_connection("127.0.0.1", proxy.port)
    try:
        yield reader, writer
    finally:
        writer.close()
        with contextlib.suppress(OSError):
            await writer.wait_closed()


async def asked(reader, writer):
    """The answer, whole, and in which pieces it came."""
    writer.write(b"?")
    pieces = []
    while sum(map(len, pieces)) < len(ANSWER):
        pieces.append(await asyncio.wait_for(reader.read(65536), 10))
        assert pieces[-1], "the connection ended"
    return b"".join(pieces), pieces


async def test_it_passes_on_and_counts(echo):
    async with FaultProxy(echo) as proxy, client(proxy) as peer:
        assert (await asked(*peer))[0] == ANSWER
        assert (proxy.accepted, proxy.open) == (1, 1)


async def test_reset_ends_what_is_open_and_lets_in_what_is_new(echo):
    async with FaultProxy(echo) as proxy:
        async with client(proxy) as (reader, writer):
            await asked(reader, writer)
            await proxy.begin(faults.RESET)
            with pytest.raises(ConnectionResetError):
                await asyncio.wait_for(reader.read(1), 10)
        async with client(proxy) as peer:
            assert (await asked(*peer))[0] == ANSWER


async def test_refused_until_it_ends(echo):
    async with FaultProxy(echo) as proxy:
        port = proxy.port
        async with proxy.suffering(faults.REFUSE):
            with pytest.raises(ConnectionRefusedError):
                await asyncio.open_connection("127.0.0.1", port)
        assert proxy.port == port
        async with client(proxy) as peer:
            assert (await asked(*peer))[0] == ANSWER


async def test_a_stall_keeps_the_connection_and_every_byte(echo):
    async with FaultProxy(echo) as proxy, client(proxy) as (reader, writer):
        async with proxy.suffering(faults.STALL):
            writer.write(b"?")
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(reader.read(1), 0.2)
        assert await asyncio.wait_for(reader.readexactly(len(ANSWER)), 10) == ANSWER


async def test_a_black_hole_accepts_and_never_answers_not_even_afterwards(echo):
    async with FaultProxy(echo) as proxy:
        async with proxy.suffering(faults.BLACK_HOLE):
            reader, writer = await asyncio.open_connection("127.0.0.1", proxy.port)
            writer.write(b"?")
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(reader.read(1), 0.2)
        writer.close()


@pytest.mark.parametrize(("fault", "least"), [(faults.LATENCY, 0.29), (faults.THROTTLE, 2.0)])
async def test_late_and_slow(echo, fault, least):
    async with FaultProxy(echo) as proxy, client(proxy) as peer, proxy.suffering(fault):
        began = time.monotonic()
        assert (await asked(*peer))[0] == ANSWER
        assert time.monotonic() - began > least


async def test_slices_are_small_and_complete(echo):
    async with FaultProxy(echo) as proxy, client(proxy) as peer, proxy.suffering(faults.SLICES):
        answer, pieces = await asked(*peer)
    assert answer == ANSWER
    assert len(pieces) > 3  # what waits in the socket is read together


async def test_a_corrupt_chunk_has_one_wrong_bit(echo):
    always = faults.Fault("always", corrupt=1.0)
    async with FaultProxy(echo) as proxy, client(proxy) as peer, proxy.suffering(always):
        answer, pieces = await asked(*peer)
    wrong = [(a ^ b).bit_count() for a, b in zip(answer, ANSWER, strict=True) if a != b]
    assert wrong
    assert set(wrong) == {1}
    assert len(wrong) <= len(pieces) + 1


@pytest.mark.parametrize(("fault", "end"), [(faults.TRUNCATE, b""), (faults.CUT, None)])
async def test_a_frame_is_cut_short(echo, fault, end):
    async with FaultProxy(echo) as proxy, client(proxy) as (reader, writer), proxy.suffering(fault):
        writer.write(b"?")
        got = b""
        with contextlib.nullcontext() if end == b"" else pytest.raises(ConnectionResetError):
            while data := await asyncio.wait_for(reader.read(65536), 10):
                got += data
    assert len(got) <= 200
    assert got == ANSWER[: len(got)]
