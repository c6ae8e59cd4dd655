"""What the contract of an effect demands: ``agent.physics.effect.Effect``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.checks.contract import demand, require, require_close, where
from agent.checks.effect_record import FACTS, OP, SAMPLES, inner
from agent.checks.effect_units import op_in_other_units, time_in_other_units
from agent.physics.bases import BASES
from agent.physics.effects.hysteresis import HysteresisEffect
from agent.physics.loop_model import LoopModel
from agent.physics.valves.damped_stem import DampedStem
from agent.units import FrictionBands
from agent.workbench.library import applies

if TYPE_CHECKING:
    from agent.physics.effect import Effect

STAGES = ("valve", "process", "sensor", "disturbance")
UNITS = ("OP", "PV", "s", "1/s", "OP/s", "PV/s", "PV/s/OP", "1/s/OP", "OP*s", "1/OP", "1")
LENGTHS = (60, SAMPLES, 100_000)
"""Samples of the records whose bounds are checked."""
SHARES = (0.0, 0.07, 0.5, 0.93, 1.0)
"""Of the range of each parameter, its ends included."""
DRAWS = 60
"""Places at which a parameter may show that it counts."""
ROUNDING = 1e-9


def models_of(effect: Effect) -> Iterator[tuple[str, LoopModel]]:
    """Yield a model with the effect on each base to which it applies, and the name of the base.

    Raises:
        ContractError: It applies to none.
    """
    found = [base for base in BASES if applies(effect, base)]
    require(found, f"its bases {effect.bases!r} name none of {', '.join(base.name for base in BASES)}")
    for base in found:
        yield f"on {base.name}", LoopModel(base, (effect,), unguarded=True)


def is_removable(effect: Effect) -> bool:
    """Return whether something removes an effect: a null, or the factors by which a disturbance counts."""
    return effect.stage == "disturbance" or any(each.null is not None for each in effect.parameters(FACTS))


@demand("effect", f"must have identifiers as names, a stage of {STAGES} and units of {UNITS}")
def names(effect: Effect) -> None:
    """Look at what a user reads."""
    require(str(effect.name).isidentifier(), f"its name is {effect.name!r}")
    require(effect.stage in STAGES, f"its stage is {effect.stage!r}")
    unknown = set(effect.bases) - {base.name for base in BASES}
    require(not unknown, f"there is no base {', '.join(sorted(unknown))}")
    parameters = effect.parameters(FACTS)
    require(len({each.name for each in parameters}) == len(parameters), "two parameters have one name")
    for each in parameters:
        require(each.name.isidentifier(), f"a parameter is named {each.name!r}")
        require(each.unit in UNITS, f"the unit of {each.name} is {each.unit!r}")


@demand("effect", "must give finite bounds in order, with its null value between them")
def bounds(effect: Effect) -> None:
    """Check the bounds of short and long records."""
    for samples in LENGTHS:
        for each in effect.parameters(replace(FACTS, samples=samples)):
            with where(f"{each.name}, {samples} samples"):
                require(-np.inf < each.low <= each.high < np.inf, f"bounds are {each.low} and {each.high}")
                require(not each.log or each.low > 0, f"searched by its logarithm from {each.low}")
                within = each.null is None or each.low <= each.null <= each.high
                require(within, f"null {each.null} is not between {each.low} and {each.high}")


@demand("effect", "must return finite numbers in the shape of what it is given, within all its bounds")
def finite_output(effect: Effect) -> None:
    """Evaluate at the bounds and between them."""
    for base, model in models_of(effect):
        for share in SHARES:
            with where(f"{base}, at {share:.0%} of each range"):
                values = inner(model, share)
                position = model.position(OP.copy(), values, FACTS)
                require(np.shape(position) == OP.shape, f"{OP.shape} positions become {np.shape(position)}")
                require(np.isfinite(position).all(), "a position is not finite")
                columns = model.columns(OP.copy(), values, FACTS)
                require(len(columns) == len(OP), f"{len(OP)} samples become {len(columns)}")
                missing = np.count_nonzero(~np.isfinite(columns))
                require(missing == 0, f"{missing} of {columns.size} numbers are not finite")
                added = columns.shape[1] - 1
                expected = effect.stage == "disturbance"
                require((added > 0) == expected, f"it adds {added} columns to PV in stage {effect.stage!r}")


@demand("effect", "must leave its input as it was")
def input_untouched(effect: Effect) -> None:
    """Lend it arrays that cannot be written."""
    for base, model in models_of(effect):
        values, op = inner(model, 0.5), OP.copy()
        for array in (values, op):
            array.setflags(write=False)
        with where(base):
            model.columns(op, values, FACTS)


@demand("effect", "must return the same each time")
def repeatable(effect: Effect) -> None:
    """Evaluate twice, with other values in between."""
    for base, model in models_of(effect):
        values = inner(model, 0.5)
        one = model.columns(OP, values, FACTS)
        model.columns(OP, inner(model, 0.07), FACTS)
        with where(base):
            require_close(model.columns(OP, values, FACTS), one, "the second response")


@demand("effect", "must do nothing at its null", is_removable)
def nothing_at_the_null(effect: Effect) -> None:
    """Compare with the base alone."""
    own = effect.parameters(FACTS)
    for base, model in models_of(effect):
        values = inner(model, 0.4)
        without = values[: len(values) - len(own)]
        for at, each in enumerate(own, start=len(without)):
            values[at] = values[at] if each.null is None else each.null
        alone = LoopModel(model.base).columns(OP, without, FACTS)[:, 0]
        with where(base):
            found = model.columns(OP, values, FACTS)[:, 0]
            require_close(found, alone, "the response", rtol=ROUNDING, atol=ROUNDING)


@demand("effect", "must change its response with each of its parameters")
def every_parameter_counts(effect: Effect) -> None:
    """Move one parameter at a time, but for constants, which are not searched."""
    for base, model in models_of(effect):
        places = {name: at for at, (name, _) in enumerate(model.parameters(FACTS))}
        left = [name for name, each in model.parameters(FACTS) if not each.constant]
        random = np.random.default_rng(0)
        for _ in range(DRAWS):
            shares = random.uniform(0, 0.8, len(places))
            values, others = inner(model, shares), inner(model, shares + 0.2)
            here = model.columns(OP, values, FACTS)
            for name in list(left):
                moved = values.copy()
                moved[places[name]] = others[places[name]]
                if not np.allclose(model.columns(OP, moved, FACTS), here):
                    left.remove(name)
            if not left:
                break
        require(not left, f"{base}: {', '.join(left)} changed nothing in {DRAWS} draws")


@demand(
    "effect",
    "must first slip where its bands and start say",
    lambda effect: isinstance(effect, HysteresisEffect),
)
def first_slip(effect: HysteresisEffect) -> None:
    """Ramp OP both ways; from there S may change, and the first slip stays."""
    for start in (6.0, -5.0):
        op = 50 + np.sign(start) * np.linspace(0, 12, 241)
        for bands in (FrictionBands(4.0, 3.0), FrictionBands(5.0, 3.5)):
            values = effect.values_of(bands, start, DampedStem(), 1.0)
            own = len(effect.parameters(FACTS))
            require(len(values) == own, f"values_of returns {len(values)} values of {own}")
            again = effect.values_of(*effect.valve_of(values, 1.0), 1.0)
            require_close(again, values, "values of the valve of these values")
            moves = np.flatnonzero(np.abs(np.diff(effect.apply(op, values, 1.0))) > 1e-6)
            require(len(moves), "it never moves")
            require_close(op[moves[0] + 1] - 50, start, "OP at the first slip less first OP", atol=0.11)


LOADED = (names, bounds, finite_output, input_untouched, repeatable, nothing_at_the_null)
"""What an effect of an installed package is checked for whenever it is used; takes some milliseconds."""
CHECKS = (*LOADED, every_parameter_counts, op_in_other_units, time_in_other_units, first_slip)
"""All checks of an effect."""
