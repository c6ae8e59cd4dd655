"""What every effect promises, those of installed packages too."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from agent.physics.bases import BASES
from agent.physics.effect import Facts
from agent.physics.effects import EFFECTS, effects
from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.loop_model import LoopModel
from agent.physics.valves.damped_stem import DampedStem
from agent.units import FrictionBands
from agent.workbench.library import applies

EACH = pytest.mark.parametrize("effect", effects(), ids=lambda effect: effect.name)
PAIRS = [(effect, base) for effect in effects() for base in BASES if applies(effect, base)]
ON_EACH_BASE = pytest.mark.parametrize(
    ("effect", "base"), PAIRS, ids=[f"{effect.name} on {base.name}" for effect, base in PAIRS]
)
FAMILIES = {
    "valve_hysteresis": {"stiction", "deadband", "asymmetric_stiction"},
    "valve_limits": {"saturation"},
    "valve_characteristic": {"characteristic"},
    "valve_speed": {"rate_limit"},
    "extra_lag": {"actuator_lag", "second_order", "sensor_lag"},
    "process_dynamics": {"integrating", "inverse_response"},
    "process_limits": {"overflow"},
    "disturbance": {"sinusoid", "load_step"},
    "gain": {"gain_change"},
}
"""Of the design page, under "Interfaces that are checked"."""
OP_POWER = {"OP": 1, "OP/s": 1, "1/OP": -1, "PV/s/OP": -1}
SECOND_POWER = {"s": 1, "1/s": -1, "OP/s": -1, "PV/s": -1, "PV/s/OP": -1}
UNITS = {"OP", "PV", "s", "1/s", "OP/s", "PV/s", "PV/s/OP", "1/OP", "1"}
PAGES = Path(__file__).parents[2] / "docs" / "effects"
N = 400


def moving_op():
    """Steps, ramps and turns between 30 and 70."""
    random = np.random.default_rng(3)
    levels = np.repeat(random.uniform(30, 70, N // 25 + 1), 25)
    return np.convolve(levels, np.full(8, 1 / 8), mode="valid")[:N]


OP = moving_op()
FACTS = Facts(
    ts=2.0,
    samples=N,
    op_low=float(OP.min()),
    op_high=float(OP.max()),
    pv_low=2.0,
    pv_high=9.0,
    period=60.0,
    op_speed=float(np.abs(np.diff(OP)).mean() / 2.0),
    gain_sign=1,
)


def inner(model, share, facts=FACTS):
    """Return values that stand at a share of each range, of its logarithm where that is searched."""
    parameters = [each for _, each in model.parameters(facts)]
    shares = np.broadcast_to(share, len(parameters))
    return np.array(
        [
            each.low * (each.high / each.low) ** part
            if each.log
            else each.low + part * (each.high - each.low)
            for each, part in zip(parameters, shares, strict=True)
        ]
    )


def converted(values, model, units, factor):
    powers = np.array([units.get(each.unit, 0) for _, each in model.parameters(FACTS)])
    return values * factor**powers


@EACH
def test_names_units_and_stage_are_known_words(effect):
    assert [each.name for each in effects()].count(effect.name) == 1
    assert effect.name.isidentifier()
    assert effect.stage in {"valve", "process", "sensor", "disturbance"}
    assert set(effect.bases) <= {base.name for base in BASES}
    parameters = effect.parameters(FACTS)
    assert len({each.name for each in parameters}) == len(parameters)
    assert all(each.name.isidentifier() and each.unit in UNITS for each in parameters)


def test_the_families_are_those_of_the_design():
    built_in = {}
    for effect in EFFECTS:
        built_in.setdefault(effect.family, set()).add(effect.name)
    assert built_in == FAMILIES


@EACH
@pytest.mark.parametrize("samples", [60, N, 100_000])
def test_bounds_are_finite_and_in_order(effect, samples):
    for each in effect.parameters(replace(FACTS, samples=samples)):
        assert -np.inf < each.low < each.high < np.inf
        assert not each.log or each.low > 0
        assert each.null is None or each.low <= each.null <= each.high


def removable(effect):
    """Whether it has a null; what disturbances add is multiplied by what is solved for."""
    return effect.stage == "disturbance" or any(each.null is not None for each in effect.parameters(FACTS))


@pytest.mark.parametrize(("effect", "base"), [pair for pair in PAIRS if removable(pair[0])])
def test_at_the_null_it_is_not_there(effect, base):
    model = LoopModel(base, (effect,))
    own = effect.parameters(FACTS)
    values = inner(model, 0.4)
    without = values[: len(values) - len(own)]
    for at, each in enumerate(own, start=len(without)):
        values[at] = values[at] if each.null is None else each.null
    response = LoopModel(base).columns(OP, without, FACTS)[:, 0]
    np.testing.assert_allclose(model.columns(OP, values, FACTS)[:, 0], response, rtol=1e-9, atol=1e-9)


@ON_EACH_BASE
@pytest.mark.parametrize("share", [0.0, 0.07, 0.5, 0.93, 1.0])
def test_what_comes_out_is_finite_and_what_goes_in_is_left(effect, base, share):
    model = LoopModel(base, (effect,))
    values, op = inner(model, share), OP.copy()
    for array in (values, op):
        array.setflags(write=False)
    columns = model.columns(op, values, FACTS)
    assert len(columns) == N
    assert (columns.shape[1] > 1) == (effect.stage == "disturbance")
    assert np.isfinite(columns).all()
    assert model.position(op, values, FACTS).shape == (N,)


@ON_EACH_BASE
def test_every_parameter_counts(effect, base):
    model = LoopModel(base, (effect,))
    names = [name for name, _ in model.parameters(FACTS)]
    random = np.random.default_rng(0)
    counts = set()
    for _ in range(60):
        shares = random.uniform(0, 0.8, len(names))
        values, others = inner(model, shares), inner(model, shares + 0.2)
        here = model.columns(OP, values, FACTS)
        for at in sorted(set(range(len(names))) - counts):
            moved = values.copy()
            moved[at] = others[at]
            if not np.allclose(model.columns(OP, moved, FACTS), here):
                counts.add(at)
    assert [name for at, name in enumerate(names) if at not in counts] == []


@ON_EACH_BASE
def test_op_in_other_units_gives_the_same_in_other_units(effect, base):
    factor = 4.0  # of two, so that no rounding lets a stem slip that grazes its threshold
    model = LoopModel(base, (effect,))
    values = inner(model, 0.3)
    scaled = replace(
        FACTS,
        op_low=factor * FACTS.op_low,
        op_high=factor * FACTS.op_high,
        op_speed=factor * FACTS.op_speed,
    )
    np.testing.assert_allclose(inner(model, 0.3, scaled), converted(values, model, OP_POWER, factor))
    columns = model.columns(OP, values, FACTS)
    other = model.columns(factor * OP, converted(values, model, OP_POWER, factor), scaled)
    gain = factor if base.linear else 1.0
    np.testing.assert_allclose(other[:, 0], gain * columns[:, 0], rtol=1e-9, atol=1e-9)
    for now, before in zip(other.T[1:], columns.T[1:], strict=True):
        np.testing.assert_allclose(now / np.linalg.norm(now), before / np.linalg.norm(before), atol=1e-9)


@ON_EACH_BASE
def test_time_in_other_units_gives_the_same(effect, base):
    factor = 64.0
    model = LoopModel(base, (effect,))
    values = inner(model, 0.3)
    scaled = replace(
        FACTS, ts=factor * FACTS.ts, period=factor * FACTS.period, op_speed=FACTS.op_speed / factor
    )
    np.testing.assert_allclose(inner(model, 0.3, scaled), converted(values, model, SECOND_POWER, factor))
    columns = model.columns(OP, values, FACTS)
    other = model.columns(OP, converted(values, model, SECOND_POWER, factor), scaled)
    gain = factor if base.name == "integrator" else 1.0
    np.testing.assert_allclose(other[:, 0], gain * columns[:, 0], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    "effect", [each for each in effects() if isinstance(each, HysteresisEffect)], ids=lambda each: each.name
)
@pytest.mark.parametrize("start", [6.0, -5.0])
def test_hysteresis_begins_with_the_slip_that_its_bands_and_start_say(effect, start):
    """From there S may change; the first slip stays."""
    op = 50 + np.sign(start) * np.linspace(0, 12, 241)
    for bands in (FrictionBands(4.0, 3.0), FrictionBands(5.0, 3.5)):
        values = effect.values_of(bands, start, DampedStem(), 1.0)
        assert len(values) == len(effect.parameters(FACTS))
        position = effect.apply(op, values, 1.0)
        moved = np.flatnonzero(np.abs(np.diff(position)) > 1e-6)[0] + 1
        assert op[moved] - 50 == pytest.approx(start, abs=0.11)


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
