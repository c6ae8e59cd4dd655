"""A request's bytes in, the answer's bytes out (Modbus application protocol 1.1b3, 6)."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence

from connectors.modbus.blocks import MOST_BITS, MOST_REGISTERS
from connectors.modbus_server.image import FUNCTION, VALUE, IllegalError, Image

MOST_WRITTEN_BITS = 1968
MOST_WRITTEN_REGISTERS = 123
_ON, _OFF = 0xFF00, 0x0000


class MalformedPduError(IllegalError):
    """A request that is none, whatever the server has: no function of ours, or not as long as it says."""


def answer(request: bytes, image: Image, by: str, malformed: Callable[[], None]) -> bytes:
    """Return the answer to one request.

    Args:
        request: Function code and what belongs to it; at least one byte, and nothing in it can do harm.
        image: What is read and written.
        by: Who sends it.
        malformed: Called where it is no request; the answer is an exception then, too.
    """
    function = request[0]
    try:
        return bytes([function]) + _answer(function, request[1:], image, by)
    except IllegalError as error:
        if isinstance(error, MalformedPduError):
            malformed()
        return bytes([function | 0x80, error.code])


def _answer(function: int, rest: bytes, image: Image, by: str) -> bytes:
    match function:
        case 1 | 2:
            address, count = _asked(rest, MOST_BITS)
            read = image.read_coils if function == 1 else image.read_discrete_inputs
            return _counted(_packed(read(address, count)))
        case 3 | 4:
            registers = image.read_registers(*_asked(rest, MOST_REGISTERS))
            return _counted(struct.pack(f">{len(registers)}H", *registers))
        case 5:
            address, value = _two(rest)
            if value not in (_ON, _OFF):
                raise MalformedPduError(VALUE)
            image.write_coils(address, [value == _ON], by)
            return rest
        case 6:
            address, value = _two(rest)
            image.write_registers(address, [value], by)
            return rest
        case 15:
            address, count, data = _written(rest, MOST_WRITTEN_BITS, lambda n: (n + 7) // 8)
            image.write_coils(address, [bool(data[i // 8] >> i % 8 & 1) for i in range(count)], by)
            return rest[:4]
        case 16:
            address, count, data = _written(rest, MOST_WRITTEN_REGISTERS, lambda n: 2 * n)
            image.write_registers(address, struct.unpack(f">{count}H", data), by)
            return rest[:4]
        case _:
            raise MalformedPduError(FUNCTION)


def _two(rest: bytes) -> tuple[int, int]:
    if len(rest) != 4:
        raise MalformedPduError(VALUE)
    first, second = struct.unpack(">HH", rest)
    return first, second


def _asked(rest: bytes, most: int) -> tuple[int, int]:
    address, count = _two(rest)
    if not 1 <= count <= most:
        raise MalformedPduError(VALUE)
    return address, count


def _written(rest: bytes, most: int, size: Callable[[int], int]) -> tuple[int, int, bytes]:
    """Return address, count and data of a request that writes several."""
    if len(rest) < 5:
        raise MalformedPduError(VALUE)
    (address, count), length, data = _two(rest[:4]), rest[4], rest[5:]
    if not 1 <= count <= most or length != len(data) or length != size(count):
        raise MalformedPduError(VALUE)
    return address, count, data


def _packed(bits: Sequence[bool]) -> bytes:
    """Return bits as bytes, the first bit the lowest."""
    return sum(bit << i for i, bit in enumerate(bits)).to_bytes((len(bits) + 7) // 8, "little")


def _counted(data: bytes) -> bytes:
    return bytes([len(data)]) + data
