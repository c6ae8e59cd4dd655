"""A diagnosis as the JSON object of ``slipjump diagnose --json``: all keys always there, null for unknown."""

from __future__ import annotations

import math

from agent.analysis.diagnosis import Diagnosis
from agent.analysis.indices import INDICES
from agent.analysis.results import IntervalEstimate, ProcessEstimate, ProcessIntervals, StictionEstimate
from agent.report.advice import advice
from agent.report.parts.benefit_words import benefit_json
from agent.report.parts.no_response_words import POSSIBLE
from agent.report.parts.stretch_words import stretches_json
from agent.report.ranking import group_of
from agent.report.reasons import reasons


def diagnosis_json(diagnosis: Diagnosis, recording: str) -> dict[str, object]:
    """Return the object for one recording; ``recording`` is the name of its file."""
    oscillation, found, sticks = diagnosis.oscillation, diagnosis.quantification, diagnosis.sticks
    before = diagnosis.as_before
    return {
        "recording": recording,
        "loop": diagnosis.loop,
        "verdict": diagnosis.verdict,
        "confidence": _number(diagnosis.confidence),
        "probability": _number(diagnosis.probability),
        "sticks": {
            "probability": None if sticks is None else _number(sticks.probability),
            "base_rate": None if sticks is None else _number(sticks.base_rate),
            "windows": None if sticks is None else _number(sticks.windows),
            "suspected": group_of(diagnosis) == "suspected",
        },
        "samples_per_period": _number(diagnosis.samples_per_period),
        "manual_percent": _number(diagnosis.manual_percent),
        "cause": diagnosis.cause,
        "causes": [{"cause": each.cause, "share": _number(each.share)} for each in diagnosis.causes],
        "class": diagnosis.stiction_class,
        "reasons": list(reasons(diagnosis)),
        "advice": list(advice(diagnosis)),
        "oscillation": {
            "detected": None if oscillation is None else oscillation.detected,
            "period_s": None if oscillation is None else _number(oscillation.period),
            "regularity": None if oscillation is None else _number(oscillation.regularity),
        },
        "no_response": no_response_json(diagnosis),
        "as_before": {
            "s": None if before is None else _number(before.s),
            "log_ratio": None if before is None else _number(before.log_ratio),
        },
        "stretches": stretches_json(diagnosis.stretches),
        "stiction": stiction_json(None if found is None else found.stiction),
        "repair": benefit_json(diagnosis.benefit, None if diagnosis.record is None else diagnosis.record.ts),
        "process": _process_json(None if found is None else found.process),
        "fit": {
            "free_run_percent": None if found is None else _number(found.free_run_percent),
            "linear_percent": None if found is None else _number(found.linear_percent),
            "search_spent": None if found is None else found.search_spent,
            "would_show": None if found is None else _number(found.would_show),
            "slip_scatter": None if found is None else _number(found.slip_scatter),
        },
        "methods": {
            name: {"verdict": result.verdict, "index": _number(result.index), "reason": result.reason}
            for name, result in diagnosis.methods.items()
        },
        "indices": {each.name: _number(diagnosis.indices.get(each.name)) for each in INDICES},
        "seconds": _number(diagnosis.seconds),
    }


def stiction_json(stiction: StictionEstimate | None) -> dict[str, object]:
    """Return f_s, f_d, s, j in OP units with their intervals; ``replay`` prints the same object."""
    return {
        "f_s": _estimate_json(None if stiction is None else stiction.f_s),
        "f_d": _estimate_json(None if stiction is None else stiction.f_d),
        "s": _estimate_json(None if stiction is None else stiction.s),
        "j": _estimate_json(None if stiction is None else stiction.j),
        "identifiable": {
            "s": None if stiction is None else stiction.identifiable_s,
            "j": None if stiction is None else stiction.identifiable_j,
        },
    }


def no_response_json(diagnosis: Diagnosis) -> dict[str, object]:
    """Return whether PV does not respond to OP, why not, and the numbers; null where that is not found."""
    found = diagnosis.no_response
    return {
        "found": found is not None,
        "cause": None if found is None else found.cause,
        "possible": [] if found is None else list(POSSIBLE[found.cause]),
        "probability": None if found is None else _number(found.probability),
        "op_travel": None if found is None else _number(found.op_travel),
        "op_spans": None if found is None else _number(found.op_spans),
        "pv": None if found is None else _number(found.level),
        "expected_pv": None if found is None else _number(found.expected),
        "deviations": None if found is None else _number(found.deviations),
        "samples": None if found is None else [found.begin, found.end],
    }


def _estimate_json(estimate: IntervalEstimate | None) -> dict[str, float | None]:
    if estimate is None:
        return {"value": None, "low": None, "high": None}
    return {"value": _number(estimate.value), "low": _number(estimate.low), "high": _number(estimate.high)}


def _process_json(process: ProcessEstimate | None) -> dict[str, object]:
    return {
        "kind": None if process is None else process.kind,
        "gain": None if process is None else _number(process.gain),
        "tau_s": None if process is None else _number(process.tau),
        "delay_s": None if process is None else _number(process.delay),
        "intervals": None if process is None else _intervals_json(process.intervals),
    }


def _intervals_json(intervals: ProcessIntervals | None) -> dict[str, object] | None:
    if intervals is None:
        return None
    return {
        "gain": _ends(intervals.gain),
        "tau_s": None if intervals.tau is None else _ends(intervals.tau),
        "delay_s": _ends(intervals.delay),
    }


def _ends(interval: tuple[float, float]) -> list[float | None]:
    return [_number(end) for end in interval]


def _number(value: float | None) -> float | None:
    """Return a plain float; JSON has neither NaN nor infinity."""
    return None if value is None or not math.isfinite(value) else float(value)
