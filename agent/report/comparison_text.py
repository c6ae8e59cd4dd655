"""A comparison in words, for a terminal."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from agent.report.numbers import odds_words, p_words, share_words, tenths
from agent.workbench.residual.axis_effects import FAMILIES_ON
from agent.workbench.residual.state_dependence import LEVEL

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agent.workbench.certainty.intervals import FittedParameter
    from agent.workbench.comparison import Comparison
    from agent.workbench.hypotheses import Candidate
    from agent.workbench.step import Step, Verdict

CHANCE = 0.2
"""p from which a reduction may be chance, whatever its interval."""
NOT_CONFIRMED = "not confirmed"
"""Of a candidate that a check lowers: it may still be the one that the verdict suggests."""
TRIED = "what would lower the held-out squared error, with 90 % interval and odds"
HARMONICS = 3
"""Of a wave that are shown."""
PANELS = 3
CANDIDATES = 5
"""Lines that are shown of each."""


def comparison_lines(found: Comparison) -> Iterator[str]:
    """Yield the staircase as a table, where the model fails, what was tried, and the verdict."""
    if not found.steps:
        yield f"{found.loop}: not testable: {found.reason}"
        return
    if found.not_validated is not None:
        yield f"{found.not_validated}; the rest goes on without it"
    validated = found.steps[0].rmse_validation is not None
    yield f"{found.loop}: error of the free run from OP, RMSE in PV units"
    yield f"  {'model':28}{'fit':>10}{'held out':>10}{'validation' if validated else '':>12}{'fit %':>8}"
    for step in found.steps:
        other = "" if step.rmse_validation is None else f"{step.rmse_validation:.4g}"
        percent = f"{step.fit_percent:.1f}"
        errors = f"{step.rmse_fit:>10.4g}{step.held_out.rmse:>10.4g}{other:>12}"
        yield f"  {step_name(step):28}{errors}{percent:>8}"
    if found.noise_floor is not None:
        yield f"  noise floor between {found.noise_floor.low:.4g} and {found.noise_floor.high:.4g}"
    yield "parameters, with 90 % intervals"
    yield from _parameters(found.steps[-1].numbers)
    yield "where this model fails: share of the residual, p"
    for panel in found.where_it_fails[:PANELS]:
        made_by = f"  made by: {causes_words(panel.axis)}" if panel.p < LEVEL else ""
        yield f"  {panel.axis:28}{100 * panel.share:>9.1f} %  {p_words(panel.p)}{made_by}"
    yield from _not_shown(found)
    for line in found.lines[:PANELS]:
        yield f"  a wave of {1 / line.frequency:.4g} s comes from outside: it keeps its own time"
    if found.candidates:
        yield TRIED
    for tried in found.candidates[:CANDIDATES]:
        interval = f"({tenths(tried.low)} to {tenths(tried.high)})"
        percent = f"{tenths(tried.error_reduction_percent):>9} %"
        yield f"  {tried.effect:28}{percent}  {interval}  {evidence_words(tried)}"
    yield from _ends(found)


def _parameters(numbers: Sequence[FittedParameter]) -> Iterator[str]:
    """Yield a line for each number; of a wave of edges, which may have twenty harmonics, the first ones."""
    for each in numbers:
        if is_printed(each.name):
            yield parameter_line(each)
    last = max((_harmonic(each.name) for each in numbers), default=1)
    if last > HARMONICS:
        yield f"  amplitudes and phases of harmonics {HARMONICS + 1} to {last}: --json has them"


def parameter_line(each: FittedParameter) -> str:
    """Return a number with its unit and interval."""
    bound = ", at the bound of its search" if each.at_bound else ""
    return (
        f"  {each.name:28}{each.value:>10.4g}{unit_behind(each)}  ({each.low:.4g} to {each.high:.4g}){bound}"
    )


def unit_behind(each: FittedParameter) -> str:
    """Return the unit of a number, to stand behind it; empty where it has none."""
    return "" if each.unit == "1" else f" {each.unit}"


def is_printed(name: str) -> bool:
    """Return whether a number is printed, and not only in JSON: not of the higher harmonics of a wave."""
    return _harmonic(name) <= HARMONICS


def _harmonic(name: str) -> int:
    """Return of which multiple of a wave's frequency a number is; 1 of any other number."""
    number = re.fullmatch(r"[^.]+\.(?:amplitude|phase)_(\d+)", name)
    return 1 if number is None else int(number[1])


def _ends(found: Comparison) -> Iterator[str]:
    if found.not_fitted:
        yield f"not fitted, for nothing hints at them: {', '.join(found.not_fitted)}"
    yield f"verdict: {verdict_words(found.verdict, found)}"
    if found.next_test is not None:
        yield f"next test: {found.next_test.words}"


def evidence_words(tried: Candidate) -> str:
    """Return what decides on a candidate, to stand beside the share of the error that it explains.

    Its odds, or of a wave the p of its held-out blocks: what an autoregression predicts has no odds.
    """
    if tried.surprises:
        return f"{NOT_CONFIRMED}: {tried.objection}"
    if tried.log10_odds is not None:
        return odds_words(tried.log10_odds)
    return "may be chance" if tried.low > 0 and tried.p >= CHANCE else p_words(tried.p)


def _not_shown(found: Comparison) -> Iterator[str]:
    """Yield what the record cannot show, the effects with the same reason in one line."""
    reasons: dict[str, list[str]] = {}
    for each in found.shown:
        if each.why_not is not None:
            reasons.setdefault(each.why_not, []).append(each.effect)
    for why, effects in reasons.items():
        yield f"this record cannot show {', '.join(effects)}: {why}"


def causes_words(axis: str) -> str:
    """Return the families of effects that make a residual follow an axis, in words."""
    return ", ".join(map(in_words, FAMILIES_ON[axis]))


def step_name(step: Step) -> str:
    """Return what the step changed, and whether that is a suggestion; of the base its name."""
    if step.added is not None:
        perhaps = " (perhaps)" if step.verdict is not None and step.verdict.kind == "suggested" else ""
        return f"+ {step.added}{perhaps}"
    if step.dropped is not None:
        return f"- {step.dropped}"
    return " ".join((step.fit.model.base.name, *step.effects))


def in_words(name: str) -> str:
    """Return a name of the program as words: ``load_step.tau`` is the tau of load step."""
    effect, _, parameter = name.rpartition(".")
    words = f"{parameter} of {effect}" if effect else parameter
    return words.replace("_", " ")


def verdict_words(verdict: Verdict, found: Comparison) -> str:
    """Return a verdict on the newest model as a sentence without its stop."""
    effect, family = in_words(verdict.effect or ""), in_words(verdict.family or "")
    others = " or ".join(in_words(each) for each in verdict.indistinguishable)
    if verdict.kind == "not_testable":
        return str(found.reason)
    lacks = "".join(f"; {each}" for each in verdict.lacks)
    if verdict.kind == "confirmed":
        return f"{effect} is missing{', and something else' if lacks else ''}{lacks}"
    if verdict.kind == "family":
        one = f"{family} is missing: this record cannot distinguish {effect} from {others}"
        return f"{one}{'; something else is missing too' if lacks else ''}{lacks}"
    if verdict.kind == "suggested":
        beside = f"; {others} would explain it as well" if others else ""
        beside += lacks
        for name in verdict.at_bound:
            beside += f"; {in_words(name)} ran into the bound of its search"
        return f"perhaps {effect} is missing, but that is not certain{beside}"
    if not found.candidates:
        shown = "no further effect was tried"
    elif found.smallest_percent is None:
        shown = "too few samples in a row count to know how small an effect would have been confirmed"
    else:
        shown = (
            f"an effect with {found.smallest_percent:.0f} % of the squared error would have been confirmed"
        )
    if verdict.kind == "none_of_the_known":
        return (
            "something is missing that none of the known effects explains: "
            f"{_where(verdict, found)}; {shown}{lacks}"
        )
    return f"no failure is visible; {shown}"


def _where(verdict: Verdict, found: Comparison) -> str:
    """Return where the newest model fails most clearly."""
    worst = found.where_it_fails[0] if found.where_it_fails else None
    if worst is not None and worst.p < LEVEL:
        axis = in_words(worst.axis)
        return f"the model fails with {axis} ({p_words(worst.p)}, {share_words(worst.share)} of the residual)"
    if found.lines:
        return f"a wave of {1 / found.lines[0].frequency:.4g} s from outside is left in the residual"
    if verdict.at_bound:
        slow = " and ".join(in_words(each) for each in verdict.at_bound)
        return f"{slow} ran into the bound of its search, as of a process that integrates"
    return "a wave in step with OP is left in the residual"
