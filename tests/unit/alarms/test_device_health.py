"""NE 107: one word for what maintenance should do."""

from dataclasses import replace

import pytest

from agent.alarms.device_health import FAILED_SIGNAL, DeviceHealth, device_health
from agent.analysis.gates import GateFault
from agent.analysis.results import Oscillation
from tests.conftest import ROOT
from tests.unit.alarms.test_alarm import diagnosis

SWINGS = Oscillation(detected=True, period=50.0, regularity=2.0)
H = DeviceHealth


@pytest.mark.parametrize(
    ("gates", "oscillation", "sticks", "expected"),
    [
        ((), None, False, H.NORMAL),
        ((), SWINGS, False, H.OUT_OF_SPECIFICATION),
        (("op_saturated",), None, False, H.OUT_OF_SPECIFICATION),
        ((), SWINGS, True, H.MAINTENANCE_REQUIRED),
        (("pv_frozen",), None, True, H.FAILURE),
        (("gaps", "manual"), None, True, H.FUNCTION_CHECK),
    ],
)
def test_status(gates, oscillation, sticks, expected):
    faults = tuple(GateFault(name, "") for name in gates)
    judged = replace(diagnosis("not_testable"), faults=faults, oscillation=oscillation)
    assert device_health(judged, sticks=sticks) is expected


def test_the_gates_that_it_names_are_there():
    page = (ROOT / "docs" / "methods" / "gates.md").read_text(encoding="utf-8")
    assert [name for name in (*FAILED_SIGNAL, "manual", "op_saturated") if f"`{name}`" not in page] == []
