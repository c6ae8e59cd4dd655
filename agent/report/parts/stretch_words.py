"""The stretches by which a long recording was judged, in words and as JSON."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from agent.durations import duration_words

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Stretches
    from agent.analysis.results import Verdict

ALONE: dict[Verdict, str] = {
    "stiction": "stiction",
    "no_stiction": "no stiction",
    "undecided": "undecided",
    "not_testable": "not testable",
}


def stretch_words(stretches: Stretches) -> tuple[str, str]:
    """Return what the stretches show together and alone, and which of them the numbers are of."""
    counts = Counter(stretches.verdicts)
    shown = ", ".join(f"{words} in {counts[verdict]}" for verdict, words in ALONE.items() if counts[verdict])
    whole, each = duration_words(stretches.whole), duration_words(stretches.seconds)
    count = len(stretches.verdicts)
    found = [f"this recording of {whole} was judged by {count} stretches of {each}: {shown}"]
    if {*stretches.verdicts} != {"not_testable"}:
        found.append(f"together the probability of stiction is {stretches.together:.2f}")
    if stretches.s is not None:
        found.append(f"S from {stretches.s[0]:.3g} to {stretches.s[1]:.3g} OP units")
    begin = duration_words(stretches.begin) if stretches.begin else "0 s"
    below = f"all numbers below are of the stretch that begins {begin} after the first sample"
    return "; ".join(found), below


def stretches_json(stretches: Stretches | None) -> dict[str, object]:
    """Return the stretches as JSON; null for each number where the recording was judged as a whole."""
    counts = Counter(() if stretches is None else stretches.verdicts)
    low, high = (None, None) if stretches is None or stretches.s is None else stretches.s
    return {
        "count": 1 if stretches is None else len(stretches.verdicts),
        "alone": {verdict: None if stretches is None else counts[verdict] for verdict in ALONE},
        "begin_s": None if stretches is None else stretches.begin,
        "seconds": None if stretches is None else stretches.seconds,
        "s_low": low,
        "s_high": high,
    }
