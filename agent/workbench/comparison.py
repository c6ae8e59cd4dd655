"""What a session found, in one value: for the JSON of ``compare``, its text and the report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.workbench.step import Step, Verdict

if TYPE_CHECKING:
    from agent.workbench.design.next_test import NextTest
    from agent.workbench.hypotheses import Candidate
    from agent.workbench.residual.line_spectrum import Line
    from agent.workbench.residual.noise_floor import NoiseFloor
    from agent.workbench.residual.where import Failure
    from agent.workbench.shown.information import Shown


@dataclass(frozen=True, slots=True)
class StepEvidence:
    """What led to a step: what was known of the model before it."""

    where_it_fails: tuple[Failure, ...] = ()
    candidates: tuple[Candidate, ...] = ()
    """Empty where not all were tried."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """The staircase, and what is said of its newest model."""

    loop: str
    steps: tuple[Step, ...]
    """Empty where no model can be fitted to the recording."""
    evidence: tuple[StepEvidence, ...]
    """Of each step; empty for the base and for an effect that was taken out."""
    where_it_fails: tuple[Failure, ...]
    """The largest share first."""
    lines: tuple[Line, ...]
    """Of the residual's spectrum that come from outside, the highest above the noise first."""
    candidates: tuple[Candidate, ...]
    """The largest reduction first."""
    verdict: Verdict
    noise_floor: NoiseFloor | None
    """None where the recording is not testable."""
    smallest_percent: float | None
    """Smallest reduction of a white residual's squares that would have been confirmed; None: not
    known, for too few samples in a row count, or nothing was tried."""
    reason: str | None
    """In plain words why the recording is not testable, or not informative; None where it is."""
    unseen: tuple[str, ...]
    """What this comparison could not have seen, one statement each."""
    shown: tuple[Shown, ...] = ()
    """What the record can show of each effect that the newest model does not have; empty: not known."""
    not_validated: str | None = None
    """In plain words why nothing could be scored on the other recording; None where it could, or there is
    none."""
    not_fitted: tuple[str, ...] = ()
    """Effects that the newest model may get, that the record could show and that nothing in it hints at."""
    next_test: NextTest | None = None
    """Distinguishes the effect of the verdict from the first that the record cannot; None without one."""


def not_testable(loop: str, reason: str) -> Comparison:
    """Return what there is to say of a recording that shows nothing."""
    return Comparison(loop, (), (), (), (), (), Verdict("not_testable"), None, None, reason, ())
