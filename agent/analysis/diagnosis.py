"""A diagnosis as facts: what was seen, fitted and weighed. ``agent.report`` makes the words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from agent.analysis.gates.rhythm import samples_per_period
from agent.analysis.record.least_step import least_step, resolution

if TYPE_CHECKING:
    from agent.analysis.benefit.benefit import Benefit
    from agent.analysis.evidence.weighing import Weighed
    from agent.analysis.gates.fault import GateFault
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.response.no_response import NoResponse
    from agent.analysis.results import (
        Cause,
        CauseShare,
        MethodResult,
        Oscillation,
        Quantification,
        Sticks,
        StictionClass,
        Verdict,
    )
    from agent.analysis.wear.as_before import AsBefore


@dataclass(frozen=True, slots=True)
class RecordSummary:
    """What a reader of the result needs to know of the window."""

    samples: int
    gaps: int
    """Samples without OP or PV, of those in automatic."""
    duplicates: int
    """Samples that were discarded because an earlier one had the same timestamp."""
    ts: float
    """Sampling time, s."""
    op_span: float
    """Max - min of OP, OP units."""
    wild: int = 0
    """Values that were taken for gaps because they lie far outside those around them."""
    samples_per_period: float | None = None
    """Of the oscillation; None where nothing oscillates."""
    resolution: float = 0.0
    """What the best positioners resolve, OP units; 0: the range of OP is not known."""
    least_step: float = 0.0
    """Smallest step of OP that a bump test can make, OP units; 0: not known."""
    manual: int | None = None
    """Samples that were cut out because the loop was not in automatic; None where the mode is not known."""
    unknown_modes: tuple[str, ...] = ()
    """Modes among these of which no table knows what they mean."""

    @classmethod
    def of(cls, window: LoopWindow, oscillation: Oscillation) -> RecordSummary:
        """Summarize a window and the oscillation that was looked for in it."""
        return cls(
            samples=0,
            gaps=0,
            duplicates=0,
            ts=window.ts,
            op_span=window.op_span,
            samples_per_period=samples_per_period(window, oscillation),
            resolution=resolution(window),
            least_step=least_step(window),
        ).counting(window)

    def counting(self, window: LoopWindow) -> RecordSummary:
        """Return the summary with samples, gaps and modes of a window: of all that a stretch is cut from."""
        automatic = window.automatic
        gaps = ~window.valid if automatic is None else ~window.valid & automatic
        return replace(
            self,
            samples=len(window),
            gaps=int(gaps.sum()),
            duplicates=window.duplicates,
            wild=window.wild,
            manual=None if automatic is None else int((~automatic).sum()),
            unknown_modes=window.unknown_modes,
        )


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
class Stretches:
    """The stretches by which a long recording was judged."""

    begin: float
    """Of the one whose numbers the diagnosis has, s from the first sample of the recording."""
    seconds: float
    """Its length, s."""
    whole: float
    """Length of the recording, s."""
    verdicts: tuple[Verdict, ...]
    """Of each stretch alone, in order of time."""
    together: float
    """Probability that the valve sticks, from all of them together, where half of the valves do."""
    s: tuple[float, float] | None
    """Least and largest S of those that alone show stiction, OP units; None where none does."""


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
    indices: Mapping[str, float | None] = field(default_factory=dict)
    """Performance indices by name (`agent.analysis.indices`), each in its unit; None where not determined."""
    no_response: NoResponse | None = None
    """The finding that PV does not respond to OP; None where there is none."""
    as_before: AsBefore | None = None
    """Whether the valve sticks as it did before; None where that is not known."""
    sticks: Sticks | None = None
    """How probable it is that the valve sticks, at the base rate of the plant; None: not computed."""
    benefit: Benefit | None = None
    """What a repair or another tuning would gain; None where the valve does not stick, or it is not known."""
    others: OtherRecordings | None = None
    """None where the recording was judged alone."""
    stretches: Stretches | None = None
    """None where the recording is no longer than a window and was judged as a whole."""
    same_event_as: str | None = None
    """Loop name of another recording that shows the same event and counts in place of this one."""
    seconds: float = 0.0
    """Wall time of the analysis, s."""
    contradicted: bool = False
    """Whether the window says ``stiction``, and the former days make that improbable: the verdict waits."""
    quiet: bool = False
    """Whether nothing happened that a valve could cause (``worth_a_fit``): the record shows little of it."""

    @property
    def probability(self) -> float | None:
        """Return the probability that the valve sticks, 0 to 1; None where nothing can be said.

        Of all recordings of the valve where there are several, else of this one, of its stretches where it is
        long; without a fit that of a loop in which nothing happened that a valve could cause.
        """
        if self.others is not None:
            return self.others.together
        if self.stretches is not None and self.verdict != "not_testable":
            return self.stretches.together
        if self.weighed is not None:
            return self.weighed.probability
        return 1 - self.confidence if self.verdict == "no_stiction" else None

    @property
    def samples_per_period(self) -> float | None:
        """Return the samples that a period of the oscillation has; None where none was found."""
        return None if self.record is None else self.record.samples_per_period

    @property
    def manual_percent(self) -> float | None:
        """Return the share of the record that was cut out because it was not in automatic, %.

        None where the mode is not known.
        """
        record = self.record
        if record is None or record.manual is None or not record.samples:
            return None
        return 100 * record.manual / record.samples

    @property
    def gates(self) -> tuple[str, ...]:
        """Names of the gates that closed some methods or all."""
        return tuple(fault.name for fault in self.faults)
