"""What a first look at a window shows, and whether that is worth a fit."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from agent.analysis.gates import ALL_KINDS, closed_kinds, gates
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.reversals import moves_beyond_noise
from agent.analysis.response.no_response import NoResponse, no_response
from agent.analysis.stiction import detect_stiction
from agent.analysis.wear.as_before import as_before

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.gates import GateFault
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import MethodResult, Oscillation
    from agent.analysis.wear.as_before import AsBefore


@dataclass(frozen=True, slots=True)
class Seen:
    """Everything that is computed of a window before a fit, each once."""

    oscillation: Oscillation
    faults: tuple[GateFault, ...]
    """Of the gates."""
    op_moves: bool
    """Whether OP moves farther than its noise explains: a loop that only responds to noise does not."""
    methods: dict[str, MethodResult]
    """Result of each stiction detector, by its name; empty where the window is not testable."""
    no_response: NoResponse | None = None
    """The finding that PV does not respond to OP; None where there is none."""
    as_before: AsBefore | None = None
    """Whether the valve sticks as it did before; None where that is not known."""
    seconds: float = field(default=0.0, compare=False)
    """Wall time of the look, s."""

    @property
    def testable(self) -> bool:
        """Whether at least one kind of method may be applied."""
        return closed_kinds(self.faults) != ALL_KINDS


def look(window: LoopWindow) -> Seen:
    """Detect oscillation, apply the gates, run the stiction detectors, test the response.

    Takes some 50 ms for 1500 samples, and more where the valve is known (``as_before``), so it is for a
    worker process, not for an event loop.
    """
    started = time.perf_counter()
    oscillation = detect_oscillation(window)
    faults = gates(window, oscillation)
    testable = closed_kinds(faults) != ALL_KINDS
    methods = detect_stiction(window, oscillation, faults) if testable else {}
    silent = no_response(window)
    before = as_before(window)
    moves = moves_beyond_noise(window.op)
    return Seen(oscillation, faults, moves, methods, silent, before, time.perf_counter() - started)


def worth_a_fit(seen: Seen) -> bool:
    """Return whether a full diagnosis of a testable window is due.

    It is where OP moves: a valve that sticks shows it at each move that it does not follow, with a rhythm or
    without. Where noise is wider than the oscillation, a rhythm shows what moves.
    """
    return seen.op_moves or seen.oscillation.detected


def without_pictures(methods: Mapping[str, MethodResult]) -> dict[str, MethodResult]:
    """Return the results without what only pictures need, which is large between processes."""
    return {name: replace(each, seen=None) for name, each in methods.items()}
