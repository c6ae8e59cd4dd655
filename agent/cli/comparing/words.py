"""What a guided comparison prints: the staircase, where the model fails, and numbered candidates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.report.comparison_text import TRIED, causes_words, evidence_words, in_words, verdict_words
from agent.report.headline import headline
from agent.report.numbers import p_words, share_words, tenths
from agent.report.terminal_pictures import residual_lines, staircase_lines
from agent.workbench.residual.state_dependence import LEVEL

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.workbench.comparison import Comparison
    from agent.workbench.hypotheses import Candidate

SHOWN = 8
"""Candidates that get a number."""
OWN_EFFECT = "docs/howto/own_effect.md"


@dataclass(frozen=True, slots=True)
class View:
    """One comparison, and its candidates in the order of their numbers."""

    found: Comparison
    numbered: tuple[Candidate, ...]
    proposed: str | None
    """Effect that Enter adds; None where nothing is proposed."""


def view_of(found: Comparison) -> View:
    """Return a comparison with its candidates numbered, the proposed one first."""
    effect = found.verdict.effect
    first = [each for each in found.candidates if each.effect == effect]
    rest = [each for each in found.candidates if each.effect != effect]
    return View(found, (*first, *rest)[:SHOWN], effect)


def lines_of(view: View) -> Iterator[str]:
    """Yield what is known of the newest model, and what may be done next."""
    found = view.found
    yield "held-out error, RMSE in PV units"
    yield from staircase_lines(found)
    if found.steps[-1].effects:
        yield f"found: {headline(found)}"
    if found.verdict.kind == "not_testable":
        yield f"verdict: {verdict_words(found.verdict, found)}"
    else:
        yield from _failure_lines(found)
    if view.numbered:
        yield TRIED
    for number, each in enumerate(view.numbered, 1):
        gain = f"{tenths(each.error_reduction_percent):>6} %  ({tenths(each.low)} to {tenths(each.high)})"
        yield f"  {number}  {each.effect:22}{gain}  {evidence_words(each)}"
    if found.verdict.kind != "not_testable":
        yield f"verdict: {verdict_words(found.verdict, found)}"
    if found.verdict.kind == "none_of_the_known":
        yield f"write an effect of your own ({OWN_EFFECT}), then compare again: this session is kept"


def prompt_of(view: View) -> str:
    """Return the question at the end of a view."""
    add = f"Enter adds {view.proposed}, " if view.proposed is not None else ""
    undo = "undo, " if len(view.found.steps) > 1 else ""
    return f"{add}a number adds that effect, {undo}report FILE.html, quit, ? for more: "


def _failure_lines(found: Comparison) -> Iterator[str]:
    failing = [each for each in found.where_it_fails if each.p < LEVEL]
    if not failing:
        yield "the residual follows no axis beyond chance"
        return
    worst = failing[0]
    yield (
        f"the model fails with {in_words(worst.axis)}: {share_words(worst.share)} of the residual, "
        f"{p_words(worst.p)}. "
        f"Such a pattern is made by: {causes_words(worst.axis)}"
    )
    yield from residual_lines(worst)
