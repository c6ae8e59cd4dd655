"""What could pass for an effect is read from the record, and fitted before the effect is confirmed."""

import pytest
from loops import slack

from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.workbench.hooks import silent
from agent.workbench.library import library
from agent.workbench.session.opening import opened
from agent.workbench.shown.neighbours import neighbours
from agent.workbench.step import step_of

LINEAR = {each.name: each for each in library(EFFECTS, Fopdt())}


@pytest.fixture(scope="module")
def band():
    """A loop with a dead band: what was opened, the base, and the model with the band alone."""
    trials, alone = opened(slack(noise=0.02), Fopdt(), map, silent)
    base = step_of(alone, trials.record, None)
    return trials, base, trials.judged_on(base, [LINEAR["deadband"]])


def test_another_valve_that_sticks_could_pass_for_a_band_and_a_bend_at_its_level_could_not(band):
    _, base, found = band
    larger = found.models["deadband"].predicts
    others = [LINEAR[name] for name in ("stiction", "rate_limit", "characteristic", "split_range")]
    near = {each.name for each in neighbours(base.predicts, larger, others)}
    assert near == {"stiction"}


def test_what_could_pass_for_it_is_fitted_before_an_effect_is_confirmed(band):
    trials, base, alone = band
    assert alone.decision.kind == "confirmed"
    able = [LINEAR[name] for name in ("deadband", "stiction", "characteristic", "load_step")]
    found = trials.judged_on(base, [LINEAR["deadband"]], able)
    assert set(found.models) == {"deadband", "stiction"}
    assert "stiction" in {found.decision.effect, *found.decision.indistinguishable}
