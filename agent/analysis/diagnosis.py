"""A diagnosis as facts: what was seen, fitted and weighed. ``agent.report`` makes the words."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.gates.fault import GateFault
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import (
        Cause,
        CauseShare,
        MethodResult,
        Oscillation,
        Quantification,
        StictionClass,
        Verdict,
    )


@dataclass(frozen=True, slots=True)
class RecordSummary:
    """What a reader of the result needs to know of the window."""

    samples: int
    gaps: int
    """Samples without OP or PV."""
    duplicates: int
    """Samples that were discarded because an earlier one had the same timestamp."""
    ts: float
    """Sampling time, s."""
    op_span: float
    """Max - min of OP, OP units."""

    @classmethod
    def of(cls, window: LoopWindow) -> RecordSummary:
        """Summarize a window."""
        gaps = int((~window.valid).sum())
        return cls(len(window), gaps, window.duplicates, window.ts, window.op_span)


@dataclass(frozen=True, slots=True)
class OtherRecordings:
    """What the other recordings of the same valve add to one of them."""

    count: int
    """Other recordings, each event once."""
    together: float
    """Probability that the valve sticks, from all recordings together."""
    alone: float | None
    """The same from this recording alone, where it decides nothing alone; None where its verdict is firm."""
    contrary: bool
    """Whether all together are sure of the contrary of its own verdict, which stays."""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Why a loop oscillates, or why that cannot be said."""

    loop: str
    verdict: Verdict
    confidence: float
    """Probability that the verdict is right, 0 to 1; 0 where there is none."""
    cause: Cause
    causes: tuple[CauseShare, ...]
    stiction_class: StictionClass | None
    """Only with verdict ``stiction``."""
    oscillation: Oscillation | None
    """None where the record is not testable."""
    quantification: Quantification | None
    """None where nothing was fitted."""
    methods: dict[str, MethodResult] = field(default_factory=dict)
    faults: tuple[GateFault, ...] = ()
    """Of the gates, each of which closed some methods or all (docs/methods/gates.md)."""
    weighed: Weighed | None = None
    """The evidence of this record alone; None where nothing was fitted."""
    record: RecordSummary | None = None
    others: OtherRecordings | None = None
    """None where the recording was judged alone."""
    same_event_as: str | None = None
    """Loop name of another recording that shows the same event and counts in place of this one."""
    seconds: float = 0.0
    """Wall time of the analysis, s."""

    @property
    def gates(self) -> tuple[str, ...]:
        """Names of the gates that closed some methods or all."""
        return tuple(fault.name for fault in self.faults)
