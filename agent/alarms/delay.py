"""On and off delay, counted in analysis windows: loop faults are slow, so seconds would mean nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Delay:
    """Changes the state of a condition only after enough consecutive windows agree."""

    on: int
    """Consecutive windows that must show the condition before it counts as present."""
    off: int
    """Consecutive windows that must not show it before it counts as gone."""
    there: bool = False
    """Whether the condition counts as present."""
    run: int = 0
    """Consecutive windows that contradict ``there``."""

    def after(self, *, seen: bool | None) -> Delay:
        """Return the state after one more window.

        Args:
            seen: Whether the window showed the condition; None (undecided) changes nothing.
        """
        if seen is None:
            return self
        if seen == self.there:
            return replace(self, run=0)
        run = self.run + 1
        if run >= (self.off if self.there else self.on):
            return replace(self, there=seen, run=0)
        return replace(self, run=run)
