"""What every stiction law promises (agent/checks/stiction_laws.py), and how it stands the stepping tests."""

from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from agent.checks import checks_of
from agent.checks.stiction_laws import (
    F_D,
    F_S,
    STEPPING,
    SteppedValve,
    bench_of,
    force_never_exceeds_static_friction,
    held_op_leaves_the_stem_where_it_is,
    ramp_slides_at_kinetic_friction,
    reversal_in_one_sample_breaks_away,
    reversal_needs_static_and_kinetic_friction,
)
from agent.physics import valves
from agent.physics.valves import LAWS
from simulators.parameters import ValveParameters
from simulators.valve import STEP, SimulatedValve

PAGES = Path(__file__).parents[2] / "docs" / "methods"
COMPARED = (PAGES / "stiction_laws.md").read_text(encoding="utf-8")
DAMPED = 0.4
"""Samples by which damping and supply keep a damped stem back."""
EACH = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)


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


BENCHES = [
    *(bench_of(law, DAMPED if law.name == "damped_stem" else 0.0) for law in LAWS),
    SteppedValve("karnopp", partial(physical, "karnopp"), late=0.3),
    SteppedValve("lugre", partial(physical, "lugre"), late=0.3),
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
@pytest.mark.parametrize("check", STEPPING, ids=lambda check: check.name)
@pytest.mark.parametrize("valve", BENCHES, ids=lambda valve: valve.name)
def test_stepping(valve, check, upward):
    tried = valve if upward else valve.mirrored()
    if (valve.name, check) in FAILS:
        with pytest.raises(AssertionError):
            check(tried)
    else:
        check(tried)


@EACH
@pytest.mark.parametrize("check", checks_of("stiction_laws"), ids=lambda check: check.name)
def test_contract(law, check):
    check(law)


@EACH
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
    printed = {row[0].strip(" `"): [cell.strip() for cell in row[1 : len(STEPPING) + 1]] for row in rows}
    expected = {
        bench.name: ["no" if (bench.name, check) in FAILS else "yes" for check in STEPPING]
        for bench in BENCHES
    }
    assert printed == expected
