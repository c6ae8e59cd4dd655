"""The weeks of one valve: windows of one loop on many days, its friction constant, worn or repaired.

Plant and controller stay; what comes from outside differs from day to day, on many days hardly anything, as
in a plant. Campaigns move the operating point. Half of the loops have something that the models of the
analysis lack (``other_recordings.with_something_unknown``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from simulators.draws.other_recordings import other_recording, with_loads, with_something_unknown
from simulators.draws.random_cascades import random_cascade
from simulators.draws.random_flows import random_flow
from simulators.draws.random_moves import log_uniform, random_moved
from simulators.draws.random_plants import random_plant
from simulators.draws.seldom_moves import SeldomKind, seldom_moved
from simulators.historian import Historian

if TYPE_CHECKING:
    from collections.abc import Iterator

    from simulators.parameters import SetPointStep, ValveParameters
    from simulators.scenario import Scenario

Course = Literal["constant", "wear", "repair", "onset"]

DAY = 86400.0
"""s"""
SOUND = ("flow", "set_point", "drift", "one_way", "cascade", "tuning", "sinusoid", "none_noise")
STICKS = ("flow_stiction", "set_point_stiction", "stiction", "one_way_stiction", "cascade_stiction")
"""Kinds of loops, each as likely as another."""
SELDOM = 0.5
"""Part of the valves that move seldom (``seldom_moves``): in a plant most set points stand for hours, and the
other kinds all move within each window."""
LEAST_S, MOST_S = 1.0, 12.0
"""Range of S, OP units, of an OP range of 100."""
LONGEST = 1200.0
"""Longest window, s."""
ACTIVITY = (0.1, 1.0)
"""Range of the moves of a day, over those of the day that the loop was drawn with."""
CAMPAIGN = 10.0
"""Standard deviation of the operating point from campaign to campaign, OP units."""
CAMPAIGN_DAYS = 5.0
"""Days of a campaign."""
WEAR = 4.0
"""S at the end over S at the begin of a course of wear."""
REPAIRED = 0.05
"""S after a repair, or before an onset, over S on the other side."""


@dataclass(frozen=True, slots=True)
class Window:
    """One window of a valve."""

    day: float
    """From the begin of the weeks."""
    scenario: Scenario
    s: float
    """True S then, OP units; 0: sound."""
    historian: Historian
    """What of it is kept."""


@dataclass(frozen=True, slots=True)
class ValveWeeks:
    """A valve and its windows, in order of time."""

    name: str
    sticks: bool
    course: Course
    windows: tuple[Window, ...]


def valve_weeks(
    seed: int, days: float, windows: int, *, sticks: bool, course: Course = "constant"
) -> ValveWeeks:
    """Draw a valve; the same seed gives the same one.

    Args:
        seed: Of everything.
        days: Length.
        windows: How many windows, at random times.
        sticks: Whether the valve sticks (before a repair).
        course: How S goes on; a sound valve is constant.
    """
    rng = np.random.default_rng([seed, 28, sticks])
    kind = str(rng.choice(STICKS if sticks else SOUND))
    inner = int(rng.integers(2**31))
    historian = Historian()
    if rng.random() < SELDOM:
        seldom: SeldomKind = "seldom_stiction" if sticks else "seldom"
        kind, (base, historian) = seldom, seldom_moved(inner, seldom)
    else:
        base = _drawn(kind, inner)
    if rng.random() < 0.5:
        base = with_something_unknown(base, rng)
    if not kind.startswith("seldom"):
        base = base.model_copy(update={"duration": min(base.duration, LONGEST)})
    valve = base.valve
    if sticks and not kind.startswith("seldom"):  # whose moves were drawn by their S
        s = log_uniform(rng, LEAST_S, MOST_S / (WEAR if course == "wear" else 1.0))
        valve = _with_s(valve, s)
    moments = np.sort(rng.uniform(0.0, days, windows))
    levels = CAMPAIGN * rng.standard_normal(int(days / CAMPAIGN_DAYS) + 1)
    found = []
    for day in moments.tolist():
        factor = _factor(course, day / days)
        op = float(np.clip(base.controller.op + levels[int(day / CAMPAIGN_DAYS)], 25.0, 75.0))
        scenario = base.model_copy(
            update={
                "start": base.start + DAY * day,
                "controller": base.controller.model_copy(update={"op": op}),
                "valve": _with_s(valve, factor * (valve.f_s + valve.f_d)) if sticks else valve,
            }
        )
        one_way = kind.startswith("one_way")
        quieter = _quieter(other_recording(scenario, rng, one_way=one_way), log_uniform(rng, *ACTIVITY))
        found.append(Window(day, quieter, quieter.valve.f_s + quieter.valve.f_d, historian))
    return ValveWeeks(f"{kind}-{seed}", sticks, course, tuple(found))


def _drawn(kind: str, seed: int) -> Scenario:
    match kind:
        case "flow" | "flow_stiction":
            return random_flow(seed, kind)
        case "one_way" | "cascade" | "one_way_stiction" | "cascade_stiction":
            return random_cascade(seed, kind)
        case "set_point" | "set_point_stiction":
            return random_moved(seed, kind)
        case "drift" | "tuning" | "sinusoid" | "none_noise" | "stiction":
            return random_plant(seed, kind)
    raise ValueError(f"no kind of loop: {kind}")


def _factor(course: Course, share: float) -> float:
    """Return S over S at the begin, at a share of the whole time."""
    if course == "wear":
        return float(WEAR**share)
    other = {"repair": share > 0.5, "onset": share <= 0.5}
    return REPAIRED if other.get(course) else 1.0


def _with_s(valve: ValveParameters, s: float) -> ValveParameters:
    """Return the valve with another S and the same J / S."""
    scale = s / (valve.f_s + valve.f_d)
    return valve.model_copy(update={"f_s": scale * valve.f_s, "f_d": scale * valve.f_d})


def _quieter(scenario: Scenario, activity: float) -> Scenario:
    """Return the loop on a day of less activity: lower moves of set point and loads."""
    set_points = tuple(_nearer(scenario.set_points, scenario.controller.sp, activity))
    return with_loads(scenario, activity).model_copy(update={"set_points": set_points})


def _nearer(steps: tuple[SetPointStep, ...], level: float, share: float) -> Iterator[SetPointStep]:
    for step in steps:
        yield step.model_copy(update={"sp": level + share * (step.sp - level)})
