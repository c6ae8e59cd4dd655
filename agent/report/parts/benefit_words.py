"""What a repair or another tuning would gain, in words and as JSON: all keys are there, null for unknown."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.analysis.benefit.benefit import Benefit, Changed, ChangeRatio


def benefit_lines(found: Benefit) -> Iterator[str]:
    """Yield one line for each measure."""
    for name, changed in (("a repair", found.repaired), ("SIMC tuning", found.retuned)):
        if changed is None:
            yield f"{name}: the loop would become unstable"
            continue
        parts = (
            f"variance of PV {_words(changed.pv_variance)}",
            f"travel of OP {_words(changed.travel)}",
            f"reversals {_words(changed.reversals)}",
        )
        yield f"{name} would give, in multiples of now: {', '.join(parts)}"


def benefit_json(found: Benefit | None, ts: float | None) -> dict[str, object]:
    """Return the object; ``ts`` is the sampling time, s."""
    if found is None or ts is None:
        return {"as_is": None, "repaired": None, "retuned": None, "simc": None}
    now, tuning = found.as_is, found.tuning
    return {
        "as_is": {
            "pv_variance": now.pv_variance,
            "travel_per_h": now.travel,
            "reversals_per_h": now.reversals,
        },
        "repaired": _changed(found.repaired),
        "retuned": _changed(found.retuned),
        "simc": {"kc": tuning.kc, "ti_s": tuning.kc * ts / tuning.ki},
    }


def _changed(changed: Changed | None) -> dict[str, object] | None:
    if changed is None:
        return None
    return {
        "pv_variance": _ratio(changed.pv_variance),
        "travel": _ratio(changed.travel),
        "reversals": _ratio(changed.reversals),
    }


def _ratio(change: ChangeRatio) -> dict[str, float]:
    return {"ratio": change.ratio, "low": change.low, "high": change.high}


def _words(change: ChangeRatio) -> str:
    return f"{change.ratio:.2g} ({change.low:.2g} to {change.high:.2g})"
