"""A dead time that a user states: in samples, or with a unit as a time."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import typer

UNITS = {"ms": 1e-3, "s": 1.0, "sec": 1.0, "min": 60.0, "h": 3600.0}
"""Unit -> s."""
WRITTEN = re.compile(r"\s*(?P<number>\d+(?:\.\d*)?|\.\d+)\s*(?P<unit>[a-z]*)\s*", re.IGNORECASE)
SAME = 1e-3
"""Part of a time by which a number of samples may be another one: sampling times are measured."""
EXPECTED = "expected whole samples, at least 1, or a time with its unit: 17s, 2min, 500ms, 1h"


@dataclass(frozen=True, slots=True)
class DeadTime:
    """A dead time, in one of two units."""

    samples: int | None = None
    seconds: float | None = None

    def at(self, ts: float) -> int:
        """Return it in samples of ``ts`` (s), at least 1: PV depends first on MV(t - D)."""
        if self.samples is not None:
            return self.samples
        return max(1, round((self.seconds or 0.0) / ts))

    def remarks(self, ts: float) -> tuple[str, ...]:
        """Return what was made of a time that is no whole number of samples of ``ts`` (s), a line each."""
        taken = self.at(ts)
        if self.seconds is None or math.isclose(taken * ts, self.seconds, rel_tol=SAME):
            return ()
        samples = "1 sample" if taken == 1 else f"{taken} samples"
        least = ", the least that there is" if self.seconds < ts * taken and taken == 1 else ""
        return (f"--delay: {self.seconds:g} s of records every {ts:g} s was taken as {samples}{least}",)


def delay_of(text: str) -> DeadTime:
    """Return the dead time that a text states; raises BadParameter where it states none."""
    found = WRITTEN.fullmatch(text)
    unit = "" if found is None else found["unit"].lower()
    if found is None or (unit and unit not in UNITS):
        raise typer.BadParameter(f"{text!r}: {EXPECTED}", param_hint="'--delay'")
    number = float(found["number"])
    if unit:
        return DeadTime(seconds=number * UNITS[unit])
    if number < 1 or number != int(number):
        raise typer.BadParameter(f"{text!r}: {EXPECTED}", param_hint="'--delay'")
    return DeadTime(samples=int(number))
