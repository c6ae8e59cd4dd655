"""A loop as a row: what the work list and the list of alarms show of it, as JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from agent.report.advice import advice
from agent.report.diagnosis_text import answers
from agent.report.ranking import GROUPS, estimate_of, probability_of
from agent.web.ranking import Item

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.analysis.results import IntervalEstimate
    from agent.runtime.loop.pipeline import LoopPipeline
    from agent.web.judgement import Judgement

POINTS = 48
"""Of a sparkline."""
STRETCH = 6.0
"""Periods of the oscillation that a sparkline shows."""
FINE = 100
"""Steps of a sparkline's height."""


def row_of(item: Item) -> dict[str, Any]:
    """Return what is shown of a loop in a list; null is not known."""
    status, alarm, diagnosis = item.status, item.alarm, item.status.diagnosis
    s = estimate_of(diagnosis)
    found = (
        None if diagnosis is None or diagnosis.quantification is None else diagnosis.quantification.stiction
    )
    return {
        "loop": status.loop,
        "area": item.area,
        "connection": status.connection,
        "bus": status.bus,
        "verdict": "none" if diagnosis is None else diagnosis.verdict,
        "group": item.group,
        "words": GROUPS[item.group],
        "cause": None if diagnosis is None else diagnosis.cause,
        "probability": plain(probability_of(diagnosis)),
        "s": None if s is None else {"value": plain(s.value), "low": plain(s.low), "high": plain(s.high)},
        "identifiable": None if found is None else found.identifiable_s,
        "doubt": "" if found is None or found.identifiable_s else _doubt(found.s),
        "since": plain(item.since),
        "alarm": alarm.state.value,
        "priority": alarm.priority,
        "by": alarm.by,
        "until": plain(alarm.until),
        "data": status.data,
        "next": next_step(item),
        "judgement": None if item.judgement is None else _judgement(item.judgement),
    }


def _judgement(each: Judgement) -> dict[str, Any]:
    return {
        "judgement": each.judgement,
        "by": each.by,
        "comment": each.comment,
        "time": plain(each.time),
    }


def _doubt(s: IntervalEstimate) -> str:
    """Return the word for an S that the record does not identify, as the text of a diagnosis has it."""
    return "uncertain" if answers(s) else "not identifiable"


def next_step(item: Item) -> str:
    """Return what to do about a loop, in a line; empty where nothing is to be done."""
    if item.stale:
        return "No data: look at the connection"
    if item.alarm.state.silenced or item.status.diagnosis is None or item.group == "healthy":
        return ""
    steps = advice(item.status.diagnosis)
    return steps[0] if steps else ""


def sparkline_of(pipeline: LoopPipeline) -> dict[str, list[int | None]] | None:
    """Return the newest PV and OP as points of a small picture, each from 0 (least) to 100; null is a gap."""
    loop = pipeline.settings
    length = 15 * POINTS * loop.ts if pipeline.window.period is None else STRETCH * pipeline.window.period
    newest = pipeline.window.newest
    if newest is None:
        return None
    _, columns = pipeline.window.recent(newest - min(length, loop.window.longest))
    return {role: _scaled(columns[role]) for role in ("pv", "op")}


def plain(value: float | None) -> float | None:
    """Return a number that JSON has; null where it is not finite."""
    return None if value is None or not math.isfinite(value) else float(value)


def numbers(values: FloatArray | None, digits: int = 6) -> list[float | None] | None:
    """Return an array as JSON, null for missing values, so many significant digits."""
    if values is None:
        return None
    return [float(f"{value:.{digits}g}") if math.isfinite(value) else None for value in values.tolist()]


def _scaled(values: FloatArray) -> list[int | None]:
    """Return at most ``POINTS`` of the values between 0 and ``FINE``."""
    if len(values) > POINTS:
        values = values[np.linspace(0, len(values) - 1, POINTS).round().astype(np.int64)]
    finite = values[np.isfinite(values)]
    low, span = (float(finite.min()), float(np.ptp(finite))) if finite.size else (0.0, 0.0)
    scale = FINE / span if span > 0 else 0.0
    middle = 0.0 if span > 0 else FINE / 2
    return [round((v - low) * scale + middle) if math.isfinite(v) else None for v in values.tolist()]
