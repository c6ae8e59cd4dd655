"""What the contract of a stiction law demands, and the stepping tests of ISA-75.25 for any valve.

Source: reference ``methods.md`` 1.5. The valve of the stepping tests has f_S = 5 and f_D = 2 OP units, its
stem stands at 0, a sample is a second. Steps stay 3 % off the thresholds: LuGre breaks away earlier the
faster the force grows. A published law may fail one of them by its nature, so they are a list of their own
(``STEPPING``); ``docs/methods/stiction_laws.md`` shows which law fails which.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.checks.contract import demand, require, require_close
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.valves import StictionLaw

    FloatArray = NDArray[np.float64]

F_S, F_D = 5.0, 2.0
"""OP units."""
BANDS = FrictionBands(f_s=F_S, f_d=F_D)
S = BANDS.s
STILL = 0.01
"""OP units by which the bristles of a LuGre stem give way."""
_T = np.arange(1500)
NOISY_SINE = np.sin(2 * np.pi * _T / 300) + 0.05 * np.random.default_rng(0).standard_normal(_T.size)
"""Amplitude 1, (1500,)."""


@dataclass(frozen=True, slots=True)
class SteppedValve:
    """A valve on the test bench: it is stepped, and its position is read."""

    name: str
    stroke: Callable[[FloatArray, float], FloatArray]
    """OP units (n,) and first position, OP units, to positions, OP units, (n,)."""
    late: float = 0.0
    """OP units by which damping keeps it back on a ramp of 1 OP unit a sample."""

    def move(self, *op: float, x0: float = 0.0) -> FloatArray:
        """Return the positions, OP units, that follow OP."""
        return self.stroke(np.array(op, dtype=np.float64), x0)

    def mirrored(self) -> SteppedValve:
        """Return the same valve upside down."""
        return SteppedValve(self.name, lambda op, x0: -self.stroke(-op, -x0), self.late)


def bench_of(law: StictionLaw, late: float = 0.0) -> SteppedValve:
    """Return the bench of a law."""
    return SteppedValve(law.name, lambda op, x0: law.position(op, BANDS, x0), late)


@demand("valve", "must not move by a step below its static friction")
def step_below_static_friction_does_not_move(valve: SteppedValve) -> None:
    """Step to 97 % of f_S both ways, and swing by 3 OP units."""
    moved = np.r_[valve.move(0.97 * F_S, 0, -0.97 * F_S, 0), valve.move(*(3 * NOISY_SINE))]
    require_close(moved, np.zeros_like(moved), "the position", atol=STILL)


@demand("valve", "must not move at the first sample where friction holds it")
def the_first_sample_makes_no_move_of_its_own(valve: SteppedValve) -> None:
    """Start with a stem that friction holds off OP."""
    for stored in (-0.97, 0.0, 0.97):
        start = 10 - stored * F_S
        require_close(valve.move(*[10.0] * 5, x0=start), np.full(5, start), "the position", atol=STILL)


@demand("valve", "must move once steps add up to its static friction")
def steps_add_up(valve: SteppedValve) -> None:
    """Step by 0.4 OP units."""
    op = np.arange(0.4, 8, 0.4)
    moved = np.abs(valve.move(*op)) > STILL
    require_close(op[moved.argmax()], 5.2, "OP at the first move", rtol=1e-6)


@demand("valve", "must stay behind a ramp by its kinetic friction")
def ramp_slides_at_kinetic_friction(valve: SteppedValve) -> None:
    """Ramp OP by 1 OP unit a sample."""
    op = np.arange(30.0)
    behind = (op - valve.move(*op))[10:]
    require_close(behind, np.full(20, F_D), "OP less position", atol=valve.late + STILL)


@demand("valve", "must turn when OP has gone back by f_S + f_D, not before")
def reversal_needs_static_and_kinetic_friction(valve: SteppedValve) -> None:
    """Turn by 97 and by 103 % of S."""
    stroke = [1.05 * F_S] * 5
    held = valve.move(*stroke, *[1.05 * F_S - 0.97 * S] * 5)
    turned = valve.move(*stroke, *[1.05 * F_S - 1.03 * S] * 5)
    require_close(held[-1], held[4], "the position after 97 % of S", rtol=1e-6, atol=STILL)
    require(turned[-1] < turned[4] - 0.9 * BANDS.j, "it does not turn after 103 % of S")


@demand("valve", "must break away when OP turns far in one sample")
def reversal_in_one_sample_breaks_away(valve: SteppedValve) -> None:
    """Turn by 15 OP units within a sample."""
    up = np.arange(21.0)
    position = valve.move(*up, 5)
    require(position[-1] < position[-2] - BANDS.j, "it stays, or moves by less than J")


@demand("valve", "must never let the force exceed its static friction")
def force_never_exceeds_static_friction(valve: SteppedValve) -> None:
    """Swing and step far."""
    op = np.concatenate([10 * NOISY_SINE, np.repeat([60.0, -20.0, 15.0], 20)])
    force = float(np.abs(op - valve.move(*op)).max())
    require(force <= F_S + 1e-9, f"OP less position reaches {force:.4g}")


@demand("valve", "must stay where it is while OP is held")
def held_op_leaves_the_stem_where_it_is(valve: SteppedValve) -> None:
    """Hold OP for 20 samples, four times."""
    position = valve.move(*np.repeat([60.0, -20.0, 15.0, 23.0], 20)).reshape(4, 20)
    require_close(np.ptp(position[:, 5:], axis=1), np.zeros(4), "the travel while OP is held", atol=STILL)


STEPPING = (
    step_below_static_friction_does_not_move,
    the_first_sample_makes_no_move_of_its_own,
    steps_add_up,
    ramp_slides_at_kinetic_friction,
    reversal_needs_static_and_kinetic_friction,
    reversal_in_one_sample_breaks_away,
    force_never_exceeds_static_friction,
    held_op_leaves_the_stem_where_it_is,
)
"""The stepping tests; they take a ``SteppedValve``."""


@demand("stiction law", "must hold its position while OP is missing")
def holds_while_op_is_missing(law: StictionLaw) -> None:
    """Lose the first OP and 20 in a row."""
    op = 10 * NOISY_SINE
    op[100:120] = np.nan
    op[0] = np.nan
    position = law.position(op, BANDS, 1.5)
    require(position[0] == 1.5, "it leaves where it rested before there is an OP")
    require(np.ptp(position[99:120]) == 0, "it moves while OP is missing")
    require(np.ptp(position[120:]) > 10, "it does not move on when OP is back")


@demand("stiction law", "must treat up and down alike")
def symmetric(law: StictionLaw) -> None:
    """Turn OP upside down."""
    op = 10 * NOISY_SINE
    require_close(law.position(op, BANDS, 1.5), -law.position(-op, BANDS, -1.5), "the position upside down")


@demand("stiction law", "must return as many positions as OP has samples and leave OP as it was")
def shape_and_input(law: StictionLaw) -> None:
    """Compare OP before and after."""
    op = 10 * NOISY_SINE
    before = op.copy()
    shape = law.position(op, BANDS, 0.0).shape
    require(shape == op.shape, f"{op.shape} samples give {shape}")
    require((op == before).all(), "it changes OP")


@demand("stiction law", "must give the same position each time, finite where OP is")
def repeatable(law: StictionLaw) -> None:
    """Move twice."""
    op = 10 * NOISY_SINE
    one = law.position(op, BANDS, 0.0)
    require(np.isfinite(one).all(), "a position is not finite")
    require_close(law.position(op, BANDS, 0.0), one, "the second position")


CHECKS = (holds_while_op_is_missing, symmetric, shape_and_input, repeatable)
"""All checks of a stiction law; the stepping tests beside them are ``STEPPING``."""
