"""Mosquitto, and a publisher of many loops that costs next to nothing: MQTT 3.1.1 written by hand."""

from __future__ import annotations

import contextlib
import shutil
import socket
import struct
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.plant.values import values_at

BURSTS = 25
"""In which the messages of a second go out: the stations of a plant do not send in the same millisecond."""
MOSQUITTO = shutil.which("mosquitto") or "/usr/sbin/mosquitto"


def free_port() -> int:
    """Return a port of loopback that nobody has."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextlib.contextmanager
def mosquitto(folder: Path) -> Iterator[int]:
    """Run a broker that drops nothing, and yield its port."""
    port = free_port()
    config = folder / "mosquitto.conf"
    config.write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\nmax_queued_messages 0\n")
    process = subprocess.Popen(  # noqa: S603 - nothing of it comes from outside
        [MOSQUITTO, "-c", str(config)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        while not _listens(port):
            time.sleep(0.05)
        yield port
    finally:
        process.kill()
        process.wait()


def topic(loop: str) -> str:
    """Return the topic of a loop's values."""
    return f"plant/{loop}"


def publish(port: int, loops: list[str], until: float) -> int:
    """Publish OP, PV and SP of each loop in one message, every second until then (s UTC); QoS 0.

    Each message bears the time at which it is sent. Returns how many messages were sent.
    """
    with socket.create_connection(("127.0.0.1", port)) as link:
        link.sendall(packet(0x10, b"\x00\x04MQTT\x04\x02" + struct.pack(">H", 0) + _text("publisher")))
        link.recv(4)
        heads = [_text(topic(name)) for name in loops]
        sent, started = 0, time.time()
        for k in range(10**9):
            table = values_at(float(k), len(loops)).tolist()
            for burst in range(BURSTS):
                due = started + k + burst / BURSTS
                time.sleep(max(due - time.time(), 0.0))
                now = time.time()
                if now >= until:
                    return sent
                packets = []
                for n in range(burst, len(loops), BURSTS):
                    op, pv, sp = table[n]
                    text = f'{{"t": {now:.6f}, "op": {op:.3f}, "pv": {pv:.3f}, "sp": {sp:.1f}}}'
                    packets.append(packet(0x30, heads[n] + text.encode()))
                link.sendall(b"".join(packets))
                sent += len(packets)
    return sent


def _listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def _text(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode()


def packet(kind: int, body: bytes) -> bytes:
    """Return a packet of MQTT: its first byte, the length of what follows, and that."""
    length, rest = b"", len(body)
    while True:
        rest, digit = divmod(rest, 128)
        length += bytes([digit | (0x80 if rest else 0)])
        if not rest:
            return bytes([kind]) + length + body
