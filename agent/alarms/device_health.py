"""NAMUR NE 107: one status for what a maintenance department should do about a device."""

from __future__ import annotations

from enum import IntEnum

from agent.analysis.diagnosis import Diagnosis

FAILED_SIGNAL = frozenset({"pv_constant", "pv_frozen", "gaps", "few_samples"})
"""Gates that close when a signal is dead or missing."""


class DeviceHealth(IntEnum):
    """The status signals of NE 107, numbered as ``DeviceHealthEnumeration`` of OPC UA Part 100."""

    NORMAL = 0
    FAILURE = 1
    FUNCTION_CHECK = 2
    OUT_OF_SPECIFICATION = 3
    MAINTENANCE_REQUIRED = 4


def device_health(diagnosis: Diagnosis, *, sticks: bool) -> DeviceHealth:
    """Return the status of the valve and its loop.

    NE 107 defines the status signals and leaves their causes to the manufacturer. Here a dead or missing
    signal is a failure, a loop in manual is under function check, a sticking valve requires maintenance, and
    a loop that oscillates for another reason or is at a limit of its valve is out of specification.

    Args:
        diagnosis: Diagnosis of the newest window.
        sticks: Whether stiction counts as present after on and off delay.
    """
    if "manual" in diagnosis.gates:
        return DeviceHealth.FUNCTION_CHECK
    if FAILED_SIGNAL & set(diagnosis.gates):
        return DeviceHealth.FAILURE
    if sticks:
        return DeviceHealth.MAINTENANCE_REQUIRED
    swings = diagnosis.oscillation is not None and diagnosis.oscillation.detected
    if swings or "op_saturated" in diagnosis.gates:
        return DeviceHealth.OUT_OF_SPECIFICATION
    return DeviceHealth.NORMAL
