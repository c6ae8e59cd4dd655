"""Many recordings as one list of valves: one answer a valve, the most urgent first; pure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from agent.analysis.results import FIRM
from agent.report.advice import advice
from agent.report.ranking import GROUPS, ORDER, estimate_of, group_of, probability_of
from agent.report.reasons import CLASS_WORDS, data_words, reasons

if TYPE_CHECKING:
    from agent.analysis.data_quality import DataQuality
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.results import IntervalEstimate, Verdict
    from agent.report.fleet.thumbnail import Thumbnail
    from agent.report.ranking import Group

NOTHING_TO_DO = "nothing"


@dataclass(frozen=True, slots=True)
class RecordFinding:
    """One recording in few numbers: thousands of them stay in memory until all are ranked."""

    recording: str
    """Name of its file."""
    loop: str
    verdict: Verdict
    group: Group
    confidence: float
    probability: float | None
    """That the valve sticks, 0 to 1; of all its recordings where they were judged together."""
    s: IntervalEstimate | None
    """OP units; None where the valve does not stick, or nothing was estimated."""
    s_identifiable: bool | None
    reason: str
    action: str
    """What to do next."""
    indices: Mapping[str, float | None]
    quality: DataQuality
    thumbnail: Thumbnail | None
    """None where no report is written."""


@dataclass(frozen=True, slots=True)
class ValveRow:
    """One valve: the answer of all its recordings."""

    name: str
    findings: tuple[RecordFinding, ...]
    lead: RecordFinding
    """The recording that speaks for the valve: of the verdict that most have, the surest."""
    group: Group

    @property
    def words(self) -> str:
        """Return its verdict in words."""
        return GROUPS[self.group]


def finding_of(
    recording: str, diagnosis: Diagnosis, quality: DataQuality, thumbnail: Thumbnail | None = None
) -> RecordFinding:
    """Return the few numbers of a diagnosis that a list of valves needs."""
    found, steps = diagnosis.quantification, advice(diagnosis)
    stiction = None if found is None else found.stiction
    return RecordFinding(
        recording=recording,
        loop=diagnosis.loop,
        verdict=diagnosis.verdict,
        group=group_of(diagnosis),
        confidence=diagnosis.confidence,
        probability=probability_of(diagnosis),
        s=estimate_of(diagnosis),
        s_identifiable=None if stiction is None else stiction.identifiable_s,
        reason=short_reason(diagnosis),
        action=steps[0] if steps else NOTHING_TO_DO,
        indices=diagnosis.indices,
        quality=quality,
        thumbnail=thumbnail,
    )


def short_reason(diagnosis: Diagnosis) -> str:
    """Return why the verdict is as it is, in few words."""
    if diagnosis.stiction_class is not None:
        return CLASS_WORDS[diagnosis.stiction_class]
    oscillation = diagnosis.oscillation
    steady = oscillation is not None and oscillation.detected and oscillation.period is not None
    if diagnosis.verdict == "no_stiction" and oscillation is not None and steady:
        return f"oscillates with a period of {oscillation.period:.4g} s for another cause"
    of_data = () if diagnosis.record is None else data_words(diagnosis.record)
    whole = replace(diagnosis, stretches=None)
    return next((each for each in reasons(whole) if each not in of_data), "")


def valve_rows(
    findings: Sequence[RecordFinding], valve: Sequence[int], names: Sequence[str]
) -> list[ValveRow]:
    """Return one row for each valve, the most urgent first.

    Within a group the more probable comes first, then the one that sticks by more.

    Args:
        findings: One for each recording that could be read.
        valve: Of each, a number that all recordings of its valve share.
        names: Of each, the name of its valve.
    """
    own: dict[int, tuple[str, list[RecordFinding]]] = {}
    for each, number, name in zip(findings, valve, names, strict=True):
        own.setdefault(number, (name, []))[1].append(each)
    rows = [ValveRow(name, tuple(some), *_answer(some)) for name, some in own.values()]
    return sorted(_distinguished(rows), key=_urgency)


def _distinguished(rows: Sequence[ValveRow]) -> list[ValveRow]:
    """Return the rows with the file behind a name that several valves have."""
    counts = Counter(each.name for each in rows)
    return [
        each if counts[each.name] == 1 else replace(each, name=f"{each.name} ({each.lead.recording})")
        for each in rows
    ]


def _answer(own: Sequence[RecordFinding]) -> tuple[RecordFinding, Group]:
    """Return the recording that speaks for the valve, and its group: firm verdicts go by majority.

    As many for as against sticking: the valve is suspected, no more.
    """
    counts = Counter(each.verdict for each in own if each.verdict in FIRM)
    sure = sorted(own, key=lambda each: -each.confidence)
    if counts["stiction"] != counts["no_stiction"]:
        verdict = "stiction" if counts["stiction"] > counts["no_stiction"] else "no_stiction"
        lead = next(each for each in sure if each.verdict == verdict)
        return lead, lead.group
    if counts["stiction"]:
        return next(each for each in sure if each.verdict == "stiction"), "suspected"
    lead = min(own, key=lambda each: ORDER[each.group])
    return lead, lead.group


def _urgency(row: ValveRow) -> tuple[float, ...]:
    s = row.lead.s
    return ORDER[row.group], -(row.lead.probability or 0.0), -(s.value if s is not None else 0.0)
