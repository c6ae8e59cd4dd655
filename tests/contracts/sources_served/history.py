"""What every server of the tests holds: two whole loops, one without OP, a tag of no loop; with flaws."""

from dataclasses import dataclass

import numpy as np

START = 1_772_352_000.0
"""2026-03-01T08:00:00Z"""
TS = 5.0
N = 260
END = START + N * TS
GAP, WORD = 17, 90
"""Sample of FIC101.PV of bad quality, and one that is a word of the historian."""


@dataclass(frozen=True)
class Value:
    """One value as a historian holds it."""

    time: float
    value: float | str
    good: bool = True


def _values(seed):
    rng = np.random.default_rng(seed)
    values = np.round(50 + rng.normal(0, 1, N), 3).tolist()
    return [Value(START + k * TS, value) for k, value in enumerate(values)]


def held():
    """Return tag -> values in order of time; some lie before and behind the span."""
    tags = {name: _values(seed) for seed, name in enumerate(["FIC101.PV", "FIC101.OP", "FIC101.SP"])}
    tags |= {name: _values(9 + seed) for seed, name in enumerate(["TIC9.PV", "TIC9.OP", "AI7.PV", "weather"])}
    pv = tags["FIC101.PV"]
    pv[GAP] = Value(pv[GAP].time, pv[GAP].value, good=False)
    pv[WORD] = Value(pv[WORD].time, "No Data")
    return {
        name: [Value(START - 60, 1.0), *values, Value(END, 2.0), Value(END + 60, 3.0)]
        for name, values in tags.items()
    }


def expected(tag):
    """Return what is to be read of a tag in the span, NaN for gaps."""
    found = [each for each in held()[tag] if START <= each.time < END]
    return np.array(
        [each.value if each.good and not isinstance(each.value, str) else np.nan for each in found]
    )
