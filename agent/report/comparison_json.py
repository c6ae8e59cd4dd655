"""A comparison as the JSON object of ``slipjump compare --json``: all keys always there, null for unknown."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.workbench.certainty.intervals import FittedParameter
    from agent.workbench.comparison import Comparison
    from agent.workbench.design.next_test import NextTest
    from agent.workbench.hypotheses import Candidate
    from agent.workbench.step import Step, Verdict


def comparison_json(found: Comparison, recording: str) -> dict[str, object]:
    """Return the object; ``recording`` is the name of its file."""
    floor = found.noise_floor
    return {
        "recording": recording,
        "loop": found.loop,
        "steps": [_step(each) for each in found.steps],
        "where_it_fails": [
            {"axis": each.axis, "share": _number(each.share), "p": _number(each.p)}
            for each in found.where_it_fails
        ],
        "waves_from_outside": [{"frequency": _number(each.frequency)} for each in found.lines],
        "candidates": [_candidate(each) for each in found.candidates],
        "verdict": _verdict(found.verdict),
        "noise_floor": {
            "low": None if floor is None else _number(floor.low),
            "high": None if floor is None else _number(floor.high),
        },
        "not_shown": not_shown_json(found),
        "not_fitted": list(found.not_fitted),
        "not_validated": found.not_validated,
        "next_test": None if found.next_test is None else _test(found.next_test),
        "smallest_visible_percent": _number(found.smallest_percent),
        "reason": found.reason,
    }


def not_shown_json(found: Comparison) -> list[dict[str, str]]:
    """Return each effect that the record cannot show, and why."""
    return [{"effect": each.effect, "why": each.why_not} for each in found.shown if each.why_not is not None]


def _test(test: NextTest) -> dict[str, object]:
    plan = test.plan
    return {
        "effects": [test.first, test.second],
        "words": test.words,
        "kind": None if plan is None else plan.kind,
        "size": None if plan is None else _number(plan.size),
        "hold_s": None if plan is None else _number(plan.hold * test.ts),
        "duration_s": None if plan is None else _number(len(plan.op) * test.ts),
        "repeats": test.repeats,
        "op": None if plan is None else [_number(each) for each in plan.op.tolist()],
    }


def _step(step: Step) -> dict[str, object]:
    return {
        "added": step.added,
        "dropped": step.dropped,
        "effects": list(step.effects),
        "rmse_fit": _number(step.rmse_fit),
        "rmse_held_out": _number(step.held_out.rmse),
        "rmse_validation": _number(step.rmse_validation),
        "fit_percent": _number(step.fit_percent),
        "verdict": None if step.verdict is None else _verdict(step.verdict),
        "parameters": {each.name: _parameter(each) for each in step.numbers},
    }


def _parameter(each: FittedParameter) -> dict[str, object]:
    return {
        "value": _number(each.value),
        "low": _number(each.low),
        "high": _number(each.high),
        "unit": each.unit,
        "at_bound": each.at_bound,
    }


def _candidate(each: Candidate) -> dict[str, object]:
    return {
        "effect": each.effect,
        "family": each.family,
        "error_reduction_percent": _number(each.error_reduction_percent),
        "low": _number(each.low),
        "high": _number(each.high),
        "p": _number(each.p),
        "log10_odds": _number(each.log10_odds),
        "objection": each.objection,
    }


def _verdict(verdict: Verdict) -> dict[str, object]:
    return {
        "kind": verdict.kind,
        "effect": verdict.effect,
        "family": verdict.family,
        "indistinguishable": list(verdict.indistinguishable),
        "at_bound": list(verdict.at_bound),
        "lacks": list(verdict.lacks),
    }


def _number(value: float | None) -> float | None:
    """Return a plain float; JSON has neither NaN nor infinity."""
    return None if value is None or not math.isfinite(value) else float(value)
