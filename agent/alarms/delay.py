"""On and off delay, counted in analysis windows: loop faults are slow, so seconds would say nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Delay:
    """Says that a condition came or went only after enough windows in a row agree."""

    on: int
    """Windows in a row that must show the condition before it counts as there."""
    off: int
    """Windows in a row that must not show it before it counts as gone."""
    there: bool = False
    """Whether the condition counts as there."""
    run: int = 0
    """Windows in a row that spoke against ``there``."""

    def after(self, *, seen: bool | None) -> Delay:
        """State after one more window.

        Args:
            seen: Whether the window showed the condition; None, it could not tell, changes nothing.
        """
        if seen is None:
            return self
        if seen == self.there:
            return replace(self, run=0)
        run = self.run + 1
        if run >= (self.off if self.there else self.on):
            return replace(self, there=seen, run=0)
        return replace(self, run=run)
