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
        "today": [_short(each) for each in memory.today],
        "processes": [
            [round(p.time), _short(p.gain), _short(p.log_gain_sd), _short(p.tau), _short(p.delay)]
            for p in memory.processes
        ],
        "checks": [_short(each) for each in memory.checks],
        "s_days": [
            [round(d.time), _short(d.s), _short(d.sd), _short(d.weight), _short(d.above)]
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
            today=_counts(names, content["today"]),
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
            checks=tuple(_number(each) for each in content.get("checks", ())),
            s_days=tuple(
                SDay(_number(t), _number(s), _number(sd), _number(w), _above(above, version))
                for t, s, sd, w, above in content["s_days"]
            ),
        )
    except (KeyError, TypeError) as error:
        raise ValueError(f"not a memory: {error}") from error


def _counts(names: list[str], values: list[Any]) -> tuple[float, ...]:
    """Return the counts in the order of ``OUTCOMES``: those that it does not know are dropped."""
    known = dict(zip(names, values, strict=True))
    return tuple(_number(known.get(each, 0.0)) for each in OUTCOMES) if names else NOTHING


def _above(value: object, version: int) -> float | None:
    """Return ``SDay.above``; before version 2 it was whether the day is a bound."""
    if version < 2:
        return math.log(WRONG) if value else None
    return None if value is None else _number(value)


def _number(value: object) -> float:
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise TypeError(f"{value!r} is not a number")
    return float(value)


def _short(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.{DIGITS}g}")
