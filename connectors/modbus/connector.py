"""Modbus TCP as a connector: polls every loop, neighbours in one request, and writes alarms."""

from __future__ import annotations

import asyncio
import logging
import math
from collections.abc import AsyncGenerator, AsyncIterator, Mapping, Sequence
from contextlib import AsyncExitStack, aclosing, asynccontextmanager

from connectors.base import (
    ConfigError,
    ConnectionLostError,
    JsonValue,
    Order,
    Publication,
    RefusedError,
    Sample,
    Session,
    TargetReport,
)
from connectors.modbus.client import DeviceError, ModbusClient, connected
from connectors.modbus.codec import encode, register_count, unscaled
from connectors.modbus.options import Flag, HoldingRegister, ModbusOptions, ModbusTag, ModbusTarget
from connectors.modbus.parking import Parking, probed
from connectors.modbus.polling import Rounds
from connectors.options import LoopTags
from connectors.readings import Readings, one_by_one

_LOG = logging.getLogger(__name__)
ModbusLoops = Mapping[str, LoopTags[ModbusTag, ModbusTarget]]


class ModbusConnector:
    """A Modbus device, what is read from it and written to it; ConfigError for impossible addresses."""

    takes_orders = False

    def __init__(self, name: str, options: ModbusOptions, loops: ModbusLoops) -> None:
        self.name = name
        self._options = options
        self._loops = loops
        self._parking = Parking(name)
        self._said_fewer = False
        if faults := list(_address_faults(loops, options.address_base)):
            raise ConfigError(faults)

    @asynccontextmanager
    async def session(self) -> AsyncIterator[Session]:
        """Connect; raises ConnectionLostError."""
        async with AsyncExitStack() as stack:
            clients = [await stack.enter_async_context(connected(self._options))]
            while len(clients) < self._options.connections:
                try:
                    clients.append(await stack.enter_async_context(connected(self._options)))
                except ConnectionLostError as error:
                    self._say_fewer(len(clients), error)
                    break
            await stack.enter_async_context(probed(self._parking, self._options))
            yield ModbusSession(clients, self._options, self._loops, self._parking)

    def _say_fewer(self, there: int, error: ConnectionLostError) -> None:
        if not self._said_fewer:
            self._said_fewer = True
            text = "connection %s: only %d of %d connections can be had: %s"
            _LOG.warning(text, self.name, there, self._options.connections, error)


class ModbusSession:
    """An open connection."""

    def __init__(
        self,
        clients: Sequence[ModbusClient],
        options: ModbusOptions,
        loops: ModbusLoops,
        parking: Parking,
    ) -> None:
        self._clients = clients
        self._client = clients[0]
        """Also writes."""
        self._options = options
        self._loops = loops
        self._parking = parking

    def samples(self) -> AsyncIterator[Sample | Order]:
        """Yield the values of every loop at every poll; raises ConnectionLostError."""
        return one_by_one(self.readings())

    async def readings(self) -> AsyncGenerator[Sample | Order | Readings]:
        """Yield the same, those of one request in one piece; raises ConnectionLostError."""
        tags = {name: loop.tags for name, loop in self._loops.items()}
        lanes = [client for client in self._clients for _ in range(self._options.requests)]
        rounds = Rounds(lanes, tags, self._options.address_base, self._parking)
        clock = asyncio.get_running_loop()
        due = clock.time()
        while True:
            async with aclosing(rounds.read()) as round_:
                async for each in round_:
                    yield each
            due = max(due + self._options.poll, clock.time())
            await asyncio.sleep(due - clock.time())

    async def publish(self, publication: Publication) -> None:
        """Write a state or its end, numbers before the flag; raises ConnectionLostError, RefusedError."""
        if publication.kind == "event" or publication.subject not in self._loops:
            return
        refused: list[str] = []
        for target in self._loops[publication.subject].targets:
            for name, place in _places(target):
                value = publication.fields.get(name)
                try:
                    await self._write(place, bool(value) if isinstance(place, Flag) else value)
                except DeviceError as error:
                    refused.append(f"{_told(place)}: {error}")
        if refused:
            raise RefusedError("; ".join(refused))

    async def check_targets(self) -> list[TargetReport]:
        """Read what would be written: whether it is there; raises ConnectionLostError."""
        places = [
            (loop, place)
            for loop, entry in self._loops.items()
            for target in entry.targets
            for _, place in _places(target)
        ]
        return [await self._look_at(loop, place) for loop, place in places]

    async def _look_at(self, loop: str, place: Flag | HoldingRegister) -> TargetReport:
        count = register_count(place.type) if isinstance(place, HoldingRegister) else 1
        try:
            await self._client.read(place.table, place.address - self._options.address_base, count)
        except DeviceError as error:
            return TargetReport(loop, _told(place), str(error))
        return TargetReport(loop, _told(place), remark="it is there; only writing shows whether it may be")

    async def _write(self, place: Flag | HoldingRegister, value: JsonValue) -> None:
        address = place.address - self._options.address_base
        if isinstance(place, HoldingRegister):
            number = float(value) if isinstance(value, int | float) else math.nan
            raw = unscaled(number, place.scale, place.offset)
            await self._client.write_registers(address, encode(raw, place.type, place.order))
        elif place.table == "holding":
            await self._client.write_registers(address, [int(bool(value))])
        else:
            await self._client.write_coil(address, bool(value))


def _places(target: ModbusTarget) -> list[tuple[str, Flag | HoldingRegister]]:
    """Return field and place of all that a target gets, the flag last."""
    flag = [] if target.active is None else [("active", target.active)]
    return [*target.fields.items(), *flag]


def _told(place: Flag | HoldingRegister) -> str:
    return f"{'coil' if place.table == 'coil' else 'holding register'} {place.address}"


def _address_faults(loops: ModbusLoops, base: int) -> list[str]:
    """Return a line for each address outside the 65536 a table has."""
    places: list[tuple[str, int, int]] = []
    for name, loop in loops.items():
        places += [(f"loops.{name}.tags.{role}", tag.address, tag.size) for role, tag in loop.tags.items()]
        for target in loop.targets:
            if target.active is not None:
                places.append((f"loops.{name}.publish.active", target.active.address, 1))
            places += [
                (f"loops.{name}.publish.fields.{field}", register.address, register_count(register.type))
                for field, register in target.fields.items()
            ]
    return [
        f"{place}.address: {address} is outside {base} to {65536 + base - size}"
        for place, address, size in places
        if not base <= address <= 65536 + base - size
    ]
