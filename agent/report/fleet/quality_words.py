"""The quality of a record in words, and what to record instead."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from agent.durations import duration_words
from agent.report.numbers import percent_words

if TYPE_CHECKING:
    from agent.analysis.data_quality import DataQuality, Flaw

FLAWS: Mapping[Flaw, Callable[[DataQuality], str]] = {
    "coarse": lambda each: f"only {each.samples_per_period:.1f} samples a period",
    "compressed": lambda each: f"compressed by the historian by about {each.compression:.0f}",
    "gaps": lambda each: f"{percent_words(each.gaps_percent)} gaps",
    "manual": lambda each: f"{percent_words(each.manual_percent or 0.0)} not in automatic",
    "saturated": lambda each: f"OP at a limit{_share(each.at_limit_percent)}",
    "short": lambda each: f"only {duration_words(each.duration)} long",
}


def _share(percent: float | None) -> str:
    return "" if percent is None else f" for {percent_words(percent)} of the time"


def quality_words(quality: DataQuality) -> str:
    """Return what spoils a verdict, or that nothing does."""
    return "; ".join(FLAWS[each](quality) for each in quality.flaws) or "good"


def record_instead(quality: DataQuality) -> str | None:
    """Return what to record in place of a record with flaws; None where it has none."""
    if not quality.flaws:
        return None
    each = "every scan" if quality.record_ts is None else f"a sample every {quality.record_ts:.2g} s"
    raw = ", raw values without compression or means" if {"coarse", "compressed"} & {*quality.flaws} else ""
    automatic = ", in automatic" if "manual" in quality.flaws else ""
    limits = ", with OP between its limits" if "saturated" in quality.flaws else ""
    return f"record {each}{raw}{automatic}{limits}, for at least {duration_words(quality.record_for)}"
