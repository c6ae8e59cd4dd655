"""A memory as text and back: compact JSON with a version, some 5 kB where a valve is watched for years."""

from __future__ import annotations

import json
import math
from typing import Any

from agent.analysis.memory.known import ProcessSeen
from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.memory.s_day import WRONG, SDay
from agent.analysis.memory.valve_memory import NOTHING, VERSION, ValveMemory

DIGITS = 6
"""Significant digits of a number; times have all of theirs to the second."""


def to_state(memory: ValveMemory) -> str:
    """Return the memory as text."""
    content = {
        "version": VERSION,
        "outcomes": list(OUTCOMES),
        "until": memory.until,
        "former": [_short(each) for each in memory.former],
        "days": [[_short(each) for each in day] for day in memory.days],
        "today": [_short(each) for each in memory.today],
        "before": [_short(each) for each in memory.before],
        "repaired": memory.repaired,
        "processes": [
            [round(p.time), _short(p.gain), _short(p.log_gain_sd), _short(p.tau), _short(p.delay)]
            for p in memory.processes
        ],
        "s_days": [
            [round(d.time), *map(_short, (d.s, d.sd, d.weight, d.above, d.half, d.agrees))]
            for d in memory.s_days
        ],
    }
    return json.dumps(content, separators=(",", ":"))


def from_state(text: str) -> ValveMemory:
    """Return the memory; of an older version what this one understands.

    Raises:
        ValueError: It is no memory, or of a newer version.
    """
    try:
        content = json.loads(text)
        version = int(content["version"])
        if version > VERSION:
            raise ValueError(f"a memory of version {version}, this slipjump reads up to version {VERSION}")
        names = content["outcomes"]
        return ValveMemory(
            until=_number(content["until"]),
            former=_counts(names, content["former"]),
            days=tuple(_counts(names, day) for day in content["days"]) if version > 3 else (),
            today=_counts(names, content["today"]),
            before=_counts(names, content["before"]) if version > 2 else NOTHING,
            repaired=_optional(content["repaired"]) if version > 2 else None,
            processes=tuple(
                ProcessSeen(
                    _number(time),
                    _number(gain),
                    _number(sd),
                    None if tau is None else _number(tau),
                    _number(delay),
                )
                for time, gain, sd, tau, delay in content["processes"]
            ),
            s_days=tuple(_day(each, version) for each in content["s_days"]),
        )
    except (KeyError, TypeError) as error:
        raise ValueError(f"not a memory: {error}") from error


def _counts(names: list[str], values: list[Any]) -> tuple[float, ...]:
    """Return the counts in the order of ``OUTCOMES``: those that it does not know are dropped."""
    known = dict(zip(names, values, strict=True))
    return tuple(_number(known.get(each, 0.0)) for each in OUTCOMES) if names else NOTHING


def _day(values: list[Any], version: int) -> SDay:
    """Return a day of S.

    In version 1 its last number was whether it is a bound. In version 2 that was ``SDay.above``, also of a
    comparison with the former S.
    """
    time, s, sd, weight = (_number(each) for each in values[:4])
    above = _optional(values[4])
    if version == 1:
        above = math.log(WRONG) if above else None
    if version > 2:
        return SDay(time, s, sd, weight, above, _number(values[5]), _optional(values[6]))
    if above is None or math.isclose(above, math.log(WRONG), rel_tol=1e-4):
        return SDay(time, s, sd, weight, above)
    return SDay(time, s, sd, weight, 0.0, s + 2 * sd, above)


def _optional(value: object) -> float | None:
    return None if value is None else _number(value)


def _number(value: object) -> float:
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise TypeError(f"{value!r} is not a number")
    return float(value)


def _short(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.{DIGITS}g}")
