"""The Modbus part of the configuration file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field, model_validator

from connectors.modbus.codec import Order, RegisterType, register_count
from connectors.options import Options, Port, Seconds, Target
from connectors.tls import Tls

Table = Literal["holding", "input", "coil", "discrete"]
Address = Annotated[int, Field(ge=0, le=65536)]
Number = Literal["time", "f_s", "f_d", "s", "j"]
"""The fields of an alarm that registers can hold."""


class ModbusOptions(Options):
    """One Modbus TCP device."""

    host: str = "127.0.0.1"
    port: Port = 502
    unit: Annotated[int, Field(ge=0, le=255)] = 1
    """Unit identifier, also called slave address."""
    poll: Seconds = 1.0
    """Time from one reading of all loops to the next, s."""
    connections: Annotated[int, Field(ge=1, le=16)] = 1
    """Connections to the device. More where a round trip takes long."""
    requests: Annotated[int, Field(ge=1, le=16)] = 1
    """Requests under way on each connection. More where the device accepts one before it has answered."""
    timeout: Seconds = 1.0
    """Longest wait for an answer, s; after that the device counts as gone."""
    address_base: Literal[0, 1] = 0
    """Number of a table's first register: 0 as on the wire, 1 as in manuals that count from 1."""
    tls: Tls | None = None
    """Modbus/TCP Security, mostly on port 802 and with a client certificate. None: not encrypted."""


class Encoding(Options):
    """How a number lies in registers. Its value is ``raw * scale + offset``."""

    type: RegisterType = "float32"
    order: Order = "ABCD"
    """Order of the bytes as they arrive, A the most significant; 16 and 64 bit go likewise."""
    scale: Annotated[float, Field(allow_inf_nan=False)] = 1.0
    offset: Annotated[float, Field(allow_inf_nan=False)] = 0.0

    @model_validator(mode="after")
    def _scale_can_be_undone(self) -> Encoding:
        if self.scale == 0:
            raise ValueError("scale must not be 0")
        return self


class ModbusTag(Encoding):
    """Where a value is read. A coil or discrete input is one bit, 0 or 1, and has no encoding."""

    table: Table
    address: Address

    @model_validator(mode="after")
    def _bits_have_no_encoding(self) -> ModbusTag:
        given = sorted(self.model_fields_set & set(Encoding.model_fields))
        if self.is_bit and given:
            raise ValueError(f"a {self.table} is a single bit: leave out {', '.join(given)}")
        return self

    @property
    def is_bit(self) -> bool:
        """Whether this is a coil or a discrete input."""
        return self.table in ("coil", "discrete")

    @property
    def size(self) -> int:
        """Registers, or bits, that it takes."""
        return 1 if self.is_bit else register_count(self.type)


def short_tag(text: str) -> dict[str, str]:
    """Return ``[table] address [type [order]]``, e.g. ``input 100 float32 CDAB``, as an entry of ``tags``."""
    words = text.split()
    keys = ["table", "address", "type", "order"]
    if words[0].isdecimal():
        del keys[0]
    last = len(keys) - 1
    return dict(zip(keys, [*words[:last], *filter(None, [" ".join(words[last:])])], strict=False))


class Flag(Options):
    """Where true and false are written: a coil, or a holding register that gets 1 or 0."""

    table: Literal["coil", "holding"] = "coil"
    address: Address


class HoldingRegister(Encoding):
    """Where a number is written."""

    table: Literal["holding"] = "holding"
    address: Address


class ModbusTarget(Target):
    """Where a loop's alarm is written; events are not, as a register keeps only the newest."""

    active: Flag | None = None
    """Is the alarm active?"""
    fields: Mapping[Number, HoldingRegister] = {}
    """Numbers that describe it. Not known: NaN, or an integer type's own word for it (see ``encode``)."""
