"""What a record shows, and the evidence for and against stiction, in plain words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agent.analysis.gates.fault import LIMIT_CYCLE, SHAPE
from agent.report.numbers import percent_words
from agent.report.parts.no_response_words import no_response_words
from agent.report.parts.stretch_words import stretch_words

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis, OtherRecordings, RecordSummary
    from agent.analysis.evidence.weighing import Weighed, Witness
    from agent.analysis.results import MethodKind, Oscillation, Quantification, StictionClass, Verdict

COARSE = 15.0
"""Samples a period below which the shape of a stroke can hardly be seen; the paper requires 50."""
MODES = 5
"""Unknown modes that are named."""
QUIET = "the loop shows no regular oscillation, and OP does not move farther than its noise"
STAYS = "the verdict of this recording stays, because a valve may be repaired or wear between two recordings"
SKIPPED: dict[frozenset[MethodKind], str] = {
    LIMIT_CYCLE: "methods that need a steady oscillation were skipped",
    SHAPE: "methods that analyse the shape of OP and PV were skipped",
}
LOAD_WAVE = "a load that oscillates by itself explains the record at least as well as a valve that sticks"
CONTRADICTED = (
    "this window shows that the valve sticks, the former days make that improbable: the verdict waits for "
    "another day that shows it"
)
CLASS_WORDS: dict[StictionClass, str] = {
    "weak": "weak stiction",
    "dead_band": "mostly a dead band",
    "stick_slip": "stick and slip",
    "dead_band_stick_slip": "a dead band with stick and slip",
}
GRADES = ((150.0, "very strong"), (20.0, "strong"), (3.0, "clear"), (1.05, "weak"))
"""Words for evidence by the factor with which it changes the odds; a smaller one is none. Steps of Kass and
Raftery, Bayes Factors, J. Am. Stat. Assoc. 90 (1995) 773, section 3.2, whose *positive* is *clear* here."""


def reasons(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return what the record shows and what speaks for and against the verdict, one statement each."""
    words = list(_own(diagnosis))
    if diagnosis.no_response is not None:
        words.insert(0, no_response_words(diagnosis.no_response))
    if diagnosis.contradicted:
        words.insert(0, CONTRADICTED)
    if diagnosis.stretches is not None:
        words[:0] = stretch_words(diagnosis.stretches)
    if diagnosis.others is not None:
        words.insert(0, _others_words(diagnosis.others))
    if diagnosis.same_event_as is not None:
        words.append(
            f"this recording shows the same event as {diagnosis.same_event_as}: the two count as one"
        )
    return tuple(words)


def _own(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return the reasons from this recording alone."""
    found, oscillation, record = diagnosis.quantification, diagnosis.oscillation, diagnosis.record
    if diagnosis.verdict == "not_testable":
        manual = "manual" in diagnosis.gates
        modes = _unknown_mode_words(record) if manual else _mode_words(record)
        return (*(fault.reason for fault in diagnosis.faults), *modes)
    if found is None or oscillation is None or record is None:
        return (*_mode_words(record), QUIET) if diagnosis.verdict == "no_stiction" else ()
    return (
        *data_words(record),
        *_oscillation_words(record, oscillation),
        *_fit_words(record, found, diagnosis),
        *_evidence_words(found, diagnosis.weighed),
        *_would_show_words(found, diagnosis.verdict),
        *_scatter_words(found, diagnosis.verdict),
        *((LOAD_WAVE,) if found.load_wave else ()),
        *(f"{fault.reason}: {SKIPPED[fault.closes]}" for fault in diagnosis.faults),
    )


WOULD_HIDE = 0.5
"""Chance that a record would show a valve that sticks, below which it says little that none was found."""
NO_FAULT = "such an S is less than the best positioners resolve (0.1 % of the range of OP), so it is no fault"
SPENT = "the search ended before one valve was clearly the best: S and J may be wrong beyond their intervals"


def data_words(record: RecordSummary) -> list[str]:
    """Return what of the record was not used, one statement each."""
    words = _mode_words(record)
    if record.gaps:
        words.append(f"{record.gaps} of {record.samples} samples are gaps and were skipped")
    if record.wild:
        words.append(f"{record.wild} values far outside those around them were taken for gaps")
    if record.duplicates:
        words.append(f"{record.duplicates} samples repeat a timestamp and were discarded")
    return words


def _mode_words(record: RecordSummary | None) -> list[str]:
    if record is None or not record.manual:
        return []
    share = f"{100 * record.manual / record.samples:.3g} % of the record"
    words = f"the loop was not in automatic for {share}; this was cut out and not used"
    return [words, *_unknown_mode_words(record)]


def _unknown_mode_words(record: RecordSummary | None) -> list[str]:
    if record is None or not record.unknown_modes:
        return []
    unknown = ", ".join(record.unknown_modes[:MODES])
    taken = f"not known as automatic or manual, so taken for manual: mode {unknown}"
    return [f"{taken}; state its meaning by modes (--modes WORD=automatic)"]


def _oscillation_words(record: RecordSummary, oscillation: Oscillation) -> list[str]:
    if not oscillation.detected or oscillation.period is None:
        return ["the loop shows no regular oscillation"]
    words = [f"the loop oscillates with a period of {oscillation.period:.4g} s"]
    samples = oscillation.period / record.ts
    if samples < COARSE:
        words.append(f"the record is coarse: {samples:.0f} samples a period")
    return words


def _fit_words(record: RecordSummary, found: Quantification, diagnosis: Diagnosis) -> list[str]:
    if found.failure is not None:
        return [f"{found.quantifier} gave no result: {found.failure}"]
    linear = f"the model without stiction fits PV to {_percent(found.linear_percent)}"
    if found.stiction is None and diagnosis.verdict == "stiction":
        return [f"{linear}; how much the valve sticks is not seen in PV"]
    if found.stiction is None:
        return [f"{linear}, and a model with stiction fits no better"]
    s, j = found.stiction.s.value, found.stiction.j.value
    span = f"{100 * s / record.op_span:.3g} % of the span of OP"
    valve = f"the model with stiction S = {s:.4g} ({span}) and J = {j:.4g}"
    words = [f"{linear}, {valve} to {_percent(found.free_run_percent)}"]
    if found.search_spent and diagnosis.verdict != "no_stiction":
        words.append(SPENT)
    if diagnosis.stiction_class is not None:
        words.append(f"the valve shows {CLASS_WORDS[diagnosis.stiction_class]}")
    elif diagnosis.verdict == "no_stiction":
        words.append("the improvement is too small to report stiction")
    elif s < record.resolution:
        words.append(NO_FAULT)
    elif not diagnosis.contradicted:
        words.append("the improvement is too small to report stiction, and too large to exclude it")
    return words


def _evidence_words(found: Quantification, weighed: Weighed | None) -> list[str]:
    """State which methods are evidence for and against stiction, the strongest first, and how strong."""
    if weighed is None or found.failure is not None or found.quick_evidence is None:
        return []
    sides = (
        ("evidence for stiction", [each for each in weighed.witnesses if each.log_odds > 0]),
        ("evidence against stiction", [each for each in weighed.witnesses if each.log_odds < 0]),
    )
    words = ((side, _graded(witnesses)) for side, witnesses in sides)
    return [f"{side}: {said}" for side, said in words if said]


def _scatter_words(found: Quantification, verdict: Verdict) -> list[str]:
    """Return how much S differs from slip to slip, of a valve that sticks."""
    if verdict != "stiction" or found.slip_scatter is None:
        return []
    percent = 100 * math.expm1(found.slip_scatter)
    return [f"S differs from slip to slip, typically by {percent:.2g} % of it; S is a middle value"]


def _would_show_words(found: Quantification, verdict: Verdict) -> list[str]:
    """State where a record would hide stiction, so that finding none says little."""
    if verdict == "stiction" or found.would_show is None or found.would_show >= WOULD_HIDE:
        return []
    cases = f"this record would show a sticking valve in {100 * found.would_show:.0f} of 100 cases"
    return [f"{cases}: OP moves too little, or noise hides what a slip does to PV"]


def _graded(witnesses: list[Witness]) -> str:
    """Name methods by the strength of their evidence; those that change nothing are left out."""
    named: dict[str, list[str]] = {}
    for each in sorted(witnesses, key=lambda each: -abs(each.log_odds)):
        times = math.exp(abs(each.log_odds))
        grade = next((words for least, words in GRADES if times >= least), None)
        if grade is not None:
            named.setdefault(grade, []).append(each.name)
    return "; ".join(f"{grade} by {', '.join(names)}" for grade, names in named.items())


def _others_words(others: OtherRecordings) -> str:
    count = "the other recording" if others.count == 1 else f"the {others.count} other recordings"
    joint = f"with {count} of this valve the probability of stiction is {others.together:.2f}"
    if others.alone is not None:
        return f"this recording alone is undecided (probability {others.alone:.2f}); {joint}"
    return f"{joint}; {STAYS}" if others.contrary else joint


def _percent(value: float | None) -> str:
    return "an unknown part" if value is None else percent_words(value)
