"""Roles by the letters of instruments, only where no word for a role makes a loop."""

import pytest

from connectors.exports.cells.instrument_tags import instrument_role
from connectors.exports.cells.tag_roles import tag_role
from connectors.exports.cells.tagging import suited


@pytest.mark.parametrize(
    ("name", "loop", "role"),
    [
        ("FT_211", "F-211", "pv"),
        ("FV_211", "F-211", "mv"),
        ("tcv101", "T-101", "mv"),
        ("TI-101 [degC]", "T-101", "pv"),
        ("11-PDIT-107A", "11-PD-107A", "pv"),
        ("\\\\PISRV\\UNIT3.LT305", "UNIT3.L-305", "pv"),
    ],
)
def test_letters_say_what_an_instrument_does(name, loop, role):
    found = instrument_role(name)
    assert (found.loop, found.role) == (loop, role)


@pytest.mark.parametrize("name", ["FIC_211", "FE_211", "FT", "time", "id", "PV", "EVENT_12", "OUT_101", "T1"])
def test_no_transmitter_and_no_valve(name):
    assert instrument_role(name) is None


def test_letters_count_where_no_word_makes_a_loop():
    assert suited(tag_role, ["time", "PT_101", "PV_101"]) is instrument_role
    assert suited(tag_role, ["FT_211", "FIC211.PV", "FIC211.OP", "FV_211"]) is tag_role
    assert suited(tag_role, ["FT_211", "TV_9"]) is tag_role


def test_a_pattern_of_ones_own_stands():
    def own(_name):
        return None

    assert suited(own, ["FT_211", "FV_211"]) is own
