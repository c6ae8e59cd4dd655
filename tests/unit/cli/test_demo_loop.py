"""When the verdict of a loop of the demo is in."""

from types import SimpleNamespace
from typing import Any

import pytest

from agent.cli.demo import DemoLoop

SOUND, STICKS, OPEN = "no_stiction", "stiction", "undecided"


def after(*verdicts: str, seen: bool = False) -> str | None:
    scenario: Any = SimpleNamespace(loop="FIC103")
    diagnoses: Any = [SimpleNamespace(verdict=verdict) for verdict in verdicts]
    return DemoLoop(scenario, "modbus", diagnoses, seen=seen).lacks(2)


@pytest.mark.parametrize(
    ("verdicts", "seen", "missing"),
    [
        ((), False, "no verdict yet"),
        ((SOUND,), False, "no 2 firm verdicts in a row that agree"),
        ((STICKS, SOUND), False, "no 2 firm verdicts in a row that agree"),
        ((STICKS, SOUND, SOUND), False, None),
        ((SOUND, OPEN), False, "its newest verdict is undecided"),
        ((OPEN, OPEN), False, "its newest verdict is undecided"),
        ((SOUND, "not_testable"), False, "its newest verdict is not testable"),
        ((SOUND, OPEN, SOUND), False, None),  # as an alarm: what is undecided says nothing against
        ((STICKS, STICKS), False, "its alarm was not seen on modbus"),
        ((STICKS, STICKS), True, None),
        ((SOUND, SOUND), True, "its alarm was seen on modbus"),
    ],
)
def test_what_is_missing(verdicts, seen, missing):
    assert after(*verdicts, seen=seen) == missing
