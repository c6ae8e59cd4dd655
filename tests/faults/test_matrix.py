"""Each fault on one bus in every test run, each fault on each bus in the bench."""

import pytest

from tests.faults.matrix import BUSES, measured, nothing_is_lost, outlived
from tests.faults.rig import rig

QUICK = {
    "modbus": {"timeout": 0.5},
    "opcua": {"timeout": 1.0, "keep_alive": 5, "retry": 0.5},
    "mqtt": {"timeout": 1.0, "keepalive": 1},
}
"""Waits that let a test end soon; the bench takes the waits that a user gets."""
SOON = {"data_age": 2.0, "longest_wait": 1.0}
ROTATED = {
    "modbus": ("reset", "stall", "slices", "cut", "source_clock_absurd"),
    "opcua": ("refuse", "latency", "removed", "twice", "full_disk"),
    "mqtt": ("black_hole", "corrupt", "truncate", "slow", "killed", "source_clock"),
}
"""Each fault once; ``gateway_clock`` has a test of its own."""
WITHIN = 5.0
"""From the peer's return until data flow again, s; asked for in the bench only, as machines are slow."""


@pytest.mark.timeout(240)
@pytest.mark.parametrize("bus", ROTATED)
async def test_one_bus_a_fault(bus, mosquitto, tmp_path, monkeypatch):
    async with rig(bus, mosquitto, tmp_path, **QUICK[bus], agent=SOON) as plant:
        for name in ROTATED[bus]:
            try:
                await outlived(plant, name, 1.0, monkeypatch)
            except BaseException as error:
                error.add_note(f"{name} on {bus}")
                raise
        await nothing_is_lost(plant)


@pytest.mark.timeout(120)
async def test_the_clock_of_this_machine_is_set(mosquitto, tmp_path, monkeypatch):
    async with rig("modbus", mosquitto, tmp_path, source_time=False, **QUICK["modbus"], agent=SOON) as plant:
        await outlived(plant, "gateway_clock", 1.0, monkeypatch)


@pytest.mark.bench
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("bus", BUSES)
async def test_every_fault_on_every_bus(bus, mosquitto, tmp_path, monkeypatch):
    took = await measured(bus, mosquitto, tmp_path, monkeypatch)
    assert {name: seconds for name, seconds in took.items() if seconds > WITHIN} == {}
