"""The sticking valves that the quantifier finds in a record less the disturbances of a model, each once."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.fit import contributions
from agent.workbench.valve_starts import valve_starts

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.record.recording import LoopWindow
    from agent.workbench.fit import Fit
    from agent.workbench.hooks import Map
    from agent.workbench.record import Record
    from agent.workbench.valve_starts import ValveStart


@dataclass(slots=True)
class ValvesBeside:
    """Of one recording."""

    window: LoopWindow
    record: Record
    run: Map
    """Works beside the program, where another core is free."""
    _sought: dict[tuple[str, ...], Iterable[tuple[ValveStart, ...]]] = field(default_factory=dict)
    """The searches that have begun, each with one result, by the disturbances of the model."""

    def with_hooks(self, run: Map) -> ValvesBeside:
        """Return the same with another pool, and with what searches that have ended have found."""
        ended: dict[tuple[str, ...], Iterable[tuple[ValveStart, ...]]] = {
            names: found for names, found in self._sought.items() if isinstance(found, tuple)
        }
        return replace(self, run=run, _sought=ended)

    def seek_beside(self, fitted: Fit) -> tuple[str, ...]:
        """Begin to look for the valves beside a model; return the names of its disturbances."""
        names = tuple(each.name for each in fitted.model.effects if each.stage == "disturbance")
        if names not in self._sought:
            parts = contributions(fitted, self.record) if names else {}
            added = sum((parts[each] for each in names), np.zeros(len(self.record)))
            self._sought[names] = self.run(valve_starts, [replace(self.window, pv=self.window.pv - added)])
        return names

    def beside(self, fitted: Fit) -> tuple[ValveStart, ...]:
        """Return the valves beside a model."""
        names = self.seek_beside(fitted)
        self._sought[names] = found = tuple(self._sought[names])
        return found[0]
