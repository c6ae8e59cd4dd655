"""What a sticking valve must do, after the stepping tests of ISA-75.25 (reference methods.md 1.5), every law.

f_S is 5 and f_D 2 OP units, the stem stands at 0, a sample is a second. Steps stay 3 % off the thresholds:
LuGre breaks away earlier the faster the force grows.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from agent.physics import valves
from agent.physics.valves import LAWS
from agent.units import FrictionBands
from simulators.parameters import ValveParameters
from simulators.valve import STEP, SimulatedValve

F_S, F_D = 5.0, 2.0
BANDS = FrictionBands(f_s=F_S, f_d=F_D)
S = BANDS.s
STILL = 0.01  # OP units by which the bristles of a LuGre stem give way
T = np.arange(1500)
NOISY_SINE = np.sin(2 * np.pi * T / 300) + 0.05 * np.random.default_rng(0).standard_normal(T.size)
PAGES = Path(__file__).parents[2] / "docs" / "methods"
COMPARED = (PAGES / "stiction_laws.md").read_text(encoding="utf-8")


@dataclass(frozen=True)
class Bench:
    """A valve that is stepped."""

    name: str
    stroke: Callable[[np.ndarray, float], np.ndarray]  # OP and first position to positions
    late: float = 0.0  # OP units by which damping keeps it back on a ramp of 1 OP unit a sample

    def move(self, *op, x0=0.0):
        return self.stroke(np.array(op, dtype=float), x0)

    def mirrored(self):
        return Bench(self.name, lambda op, x0: -self.stroke(-op, -x0), self.late)


def physical(friction, op, x0):
    """Positions at the samples of a valve that is integrated in milliseconds, OP held for 50 ms each.

    OP goes in a straight line from sample to sample: held for a second, a ramp is a row of steps, and the
    stem rests between them.
    """
    stem = SimulatedValve(ValveParameters(law=friction, f_s=F_S, f_d=F_D), (-100.0, 100.0), x0)
    stem._state[1] = x0
    dt, pieces = STEP[friction], 20
    line = np.interp(np.arange(1, pieces * (op.size + 1)) / pieces, np.arange(op.size + 1), [x0, *op])
    positions = [stem.stroke(each, round(1 / pieces / dt), dt)[-1] for each in line]
    return np.array(positions[pieces - 1 :: pieces])


def of_law(law):
    late = 0.4 if law.name == "damped_stem" else 0.0  # its damping and supply, samples
    return Bench(law.name, lambda op, x0: law.position(op, BANDS, x0), late)


BENCHES = [
    *map(of_law, LAWS),
    Bench("karnopp", partial(physical, "karnopp"), late=0.3),
    Bench("lugre", partial(physical, "lugre"), late=0.3),
]


def step_below_static_friction_does_not_move(valve):
    assert valve.move(0.97 * F_S, 0, -0.97 * F_S, 0) == pytest.approx(0, abs=STILL)
    assert valve.move(*(3 * NOISY_SINE)) == pytest.approx(0, abs=STILL)


def the_first_sample_makes_no_move_of_its_own(valve):
    for stored in (-0.97, 0.0, 0.97):
        assert valve.move(*[10] * 5, x0=10 - stored * F_S) == pytest.approx(10 - stored * F_S, abs=STILL)


def steps_add_up(valve):
    op = np.arange(0.4, 8, 0.4)
    moved = np.abs(valve.move(*op)) > STILL
    assert op[moved.argmax()] == pytest.approx(5.2)


def ramp_slides_at_kinetic_friction(valve):
    op = np.arange(30.0)
    behind = (op - valve.move(*op))[10:]
    assert behind == pytest.approx(F_D, abs=valve.late + STILL)


def reversal_needs_static_and_kinetic_friction(valve):
    stroke = [1.05 * F_S] * 5
    held = valve.move(*stroke, *[1.05 * F_S - 0.97 * S] * 5)
    turned = valve.move(*stroke, *[1.05 * F_S - 1.03 * S] * 5)
    assert held[-1] == pytest.approx(held[4], abs=STILL)
    assert turned[-1] < turned[4] - 0.9 * BANDS.j


def reversal_in_one_sample_breaks_away(valve):
    up = np.arange(21.0)
    position = valve.move(*up, 5)
    assert position[-1] < position[-2] - BANDS.j


def force_never_exceeds_static_friction(valve):
    op = np.concatenate([10 * NOISY_SINE, np.repeat([60.0, -20.0, 15.0], 20)])
    assert np.abs(op - valve.move(*op)).max() <= F_S + 1e-9


def held_op_leaves_the_stem_where_it_is(valve):
    position = valve.move(*np.repeat([60.0, -20.0, 15.0, 23.0], 20)).reshape(4, 20)
    assert np.ptp(position[:, 5:], axis=1) == pytest.approx(0, abs=STILL)


CHECKS = [
    step_below_static_friction_does_not_move,
    the_first_sample_makes_no_move_of_its_own,
    steps_add_up,
    ramp_slides_at_kinetic_friction,
    reversal_needs_static_and_kinetic_friction,
    reversal_in_one_sample_breaks_away,
    force_never_exceeds_static_friction,
    held_op_leaves_the_stem_where_it_is,
]

FAILS = {
    ("karnopp", force_never_exceeds_static_friction): "a stroke takes its time",
    ("lugre", force_never_exceeds_static_friction): "a stroke takes its time",
    ("he2007", ramp_slides_at_kinetic_friction): "rests after each slip and climbs stairs of J",
    ("stenman2003", ramp_slides_at_kinetic_friction): "rests after each jump and climbs stairs of d",
    ("stenman2003", reversal_needs_static_and_kinetic_friction): "has no kinetic friction: d is enough",
    ("he_wang2014", ramp_slides_at_kinetic_friction): "rests after each slip, ahead of its balance",
    ("he_wang2014", reversal_needs_static_and_kinetic_friction): "stands ahead of its balance after a slip",
    ("he_wang2014", force_never_exceeds_static_friction): "a large step overshoots by more than f_S",
    ("he_wang2014", held_op_leaves_the_stem_where_it_is): "swings back and forth after a large step",
    (
        "damped_stem",
        reversal_in_one_sample_breaks_away,
    ): "comes to rest first and breaks away in the next sample",
    ("damped_stem", force_never_exceeds_static_friction): "a stroke takes its time",
}


@pytest.mark.parametrize("upward", [True, False], ids=["up", "down"])
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("valve", BENCHES, ids=lambda valve: valve.name)
def test_stepping(valve, check, upward):
    tried = valve if upward else valve.mirrored()
    if (valve.name, check) in FAILS:
        with pytest.raises(AssertionError):
            check(tried)
    else:
        check(tried)


laws = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)


@laws
def test_a_missing_op_holds_the_position(law):
    op = 10 * NOISY_SINE
    op[100:120] = np.nan
    op[0] = np.nan
    position = law.position(op, BANDS, 1.5)
    assert position[0] == 1.5
    assert np.ptp(position[99:120]) == 0
    assert np.ptp(position[120:]) > 10


@laws
def test_up_and_down_are_alike(law):
    op = 10 * NOISY_SINE
    np.testing.assert_array_equal(law.position(op, BANDS, 1.5), -law.position(-op, BANDS, -1.5))


@laws
def test_op_is_left_as_it_was(law):
    op = 10 * NOISY_SINE
    before = op.copy()
    assert law.position(op, BANDS, 0.0).shape == op.shape
    np.testing.assert_array_equal(op, before)


@laws
def test_a_law_is_found_by_the_name_of_its_kernel_and_its_page(law):
    assert valves.law(law.name) is law
    assert [each.name for each in LAWS].count(law.name) == 1
    assert hasattr(import_module(f"agent.physics.valves.{law.name}"), law.name)
    page = (PAGES / f"{law.name}.md").read_text(encoding="utf-8")
    assert f"../pictures/law_{law.name}.png" in page
    assert "## Source" in page


def test_an_unknown_law_is_refused_with_the_names_there_are():
    with pytest.raises(ValueError, match=r"'kano'.*kano2004"):
        valves.law("kano")


def test_the_page_that_compares_the_laws_says_what_each_check_gave():
    rows = [line.split("|")[1:-1] for line in COMPARED.splitlines() if line.startswith("| `")]
    checked = {row[0].strip(" `"): [cell.strip() for cell in row[1 : len(CHECKS) + 1]] for row in rows}
    expected = {
        bench.name: ["no" if (bench.name, check) in FAILS else "yes" for check in CHECKS] for bench in BENCHES
    }
    assert checked == expected
