"""Qualities of values as historians write them: words, OPC codes, PI and DeltaV states."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from connectors.base import Quality

GOOD_WORDS = frozenset(
    {
        "good",
        "ok",
        "g",
        "gut",
        "valid",
        "normal",
        "true",
        "actual",
        "measured",
        "goodnoncascade",
        "goodcascade",
        "confident",
        "raw",
    }
)
"""Lower case. DeltaV writes GoodNonCascade, Ignition Good, PHD a confidence of 100."""
UNCERTAIN_AS_GOOD = ("uncertain", "subnormal", "substituted", "questionable")
"""A value that its source doubts but has: its shape still shows the valve."""
OPC_GOOD = 192
"""OPC Classic: 192 to 255 is good, 64 to 127 uncertain, less bad. OPC UA: 0 is good, large codes are not."""
OPC_UNCERTAIN = 64
PHD_CONFIDENT = 50.0
"""Honeywell PHD: confidence in percent."""


def usable(qualities: Sequence[str]) -> NDArray[np.bool_]:
    """Return whether each value may be used, shape (n,).

    Numbers are OPC Classic codes where one reaches 192; 0 to 100 with none above are percent of confidence
    where one exceeds 1, else flags (0 good as in OPC UA where zero is the usual number, else 1 good).
    """
    places: dict[str, int] = {}  # a column has few different words
    found = (places.setdefault(each, len(places)) for each in qualities)
    kinds = np.fromiter(found, np.int32, len(qualities))
    words = [each.strip().casefold() for each in places]
    numbers = [code_of(word) for word in words]
    counts = np.bincount(kinds, minlength=len(words)).tolist()
    codes = {k: number for k, number in enumerate(numbers) if number is not None}
    threshold, zero_good = _reading_of(
        list(codes.values()),
        ones=sum(counts[k] * number for k, number in codes.items()) * 2 >= sum(counts[k] for k in codes),
    )
    good = [
        _good(word, number, threshold, zero_good=zero_good)
        for word, number in zip(words, numbers, strict=True)
    ]
    return np.array(good, np.bool_)[kinds]


def _reading_of(codes: Sequence[float], *, ones: bool) -> tuple[float, bool]:
    """Return the least code that is usable, and whether zero is good.

    Args:
        codes: Each that there is.
        ones: Whether they are 1 in the mean of all values as often as 0, or more often.
    """
    if not codes or max(codes) == 0:
        return 1.0, True
    if max(codes) >= OPC_GOOD:
        if max(codes) < 256:
            return OPC_UNCERTAIN, False
        return float("inf"), True
    if max(codes) > 1:
        return PHD_CONFIDENT, False
    return (1.0, False) if ones else (float("inf"), True)


def _good(word: str, number: float | None, threshold: float, *, zero_good: bool) -> bool:
    if number is not None:
        return number >= threshold or (zero_good and number == 0)
    return quality_of_word(word) is not Quality.BAD


def quality_of_word(word: str) -> Quality:
    """Return what a word says of its value, in any case; good where no quality was written."""
    if not word.strip():
        return Quality.GOOD
    plain = word.casefold().replace(" ", "").replace("_", "").split(",")[0].split("(")[0]
    if plain in GOOD_WORDS or plain.startswith("good"):
        return Quality.GOOD
    return Quality.UNCERTAIN if plain.startswith(UNCERTAIN_AS_GOOD) else Quality.BAD


def code_of(word: str) -> float | None:
    """Return the number that a quality is, as ``192`` or ``0x80000000``; None where it is a word."""
    try:
        return float(int(word, 16)) if word.startswith("0x") else float(word)
    except ValueError:
        return None
