"""What every effect promises, those of installed packages too: agent/checks/effects.py."""

from pathlib import Path

import pytest

from agent.checks import checks_of
from agent.checks.effect_record import FACTS
from agent.physics.effects import EFFECTS, effects

PAIRS = [(effect, check) for effect in effects() for check in checks_of("effects", effect)]
FAMILIES = {
    "valve_hysteresis": {"stiction", "deadband", "asymmetric_stiction"},
    "valve_limits": {"saturation"},
    "valve_characteristic": {"characteristic", "split_range"},
    "valve_speed": {"rate_limit"},
    "extra_lag": {"actuator_lag", "second_order", "sensor_lag"},
    "process_dynamics": {"integrating", "inverse_response"},
    "process_limits": {"overflow"},
    "disturbance": {"sinusoid", "load_step", "wave"},
    "gain": {"gain_change"},
    "pv_gain": {"pv_gain", "loss_curve", "square_law", "titration"},
    "sensor_hysteresis": {"sensor_deadband"},
    "process_delay": {"transport_delay"},
    "process_friction": {"process_friction"},
}
"""Of the design page, under "Interfaces that are checked", and those of decision 64."""
PAGES = Path(__file__).parents[2] / "docs" / "effects"


def test_names_differ():
    names = [effect.name for effect in effects()]
    assert len(set(names)) == len(names)


def test_the_families_are_those_of_the_design():
    built_in = {}
    for effect in EFFECTS:
        built_in.setdefault(effect.family, set()).add(effect.name)
    assert built_in == FAMILIES


@pytest.mark.parametrize(
    ("effect", "check"), PAIRS, ids=[f"{effect.name}-{check.name}" for effect, check in PAIRS]
)
def test_contract(effect, check):
    check(effect)


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_there_is_a_page_that_says_what_to_look_for(effect):
    page = (PAGES / f"{effect.name}.md").read_text(encoding="utf-8")
    assert page.startswith(f"# `{effect.name}`")
    assert "../pictures/" in page
    for each in effect.parameters(FACTS):
        assert f"| `{each.name}` | {each.unit} |" in page
    for heading in ("## What its absence looks like", "## What it is confused with", "## Source"):
        assert heading in page


def test_the_table_of_effects_names_every_one_with_its_family_and_stage():
    table = (PAGES / "index.md").read_text(encoding="utf-8")
    for effect in EFFECTS:
        assert f"| [`{effect.name}`]({effect.name}.md) | `{effect.family}` | {effect.stage} |" in table
