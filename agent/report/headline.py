"""What a comparison found, in one line: each effect with its numbers, and by how much the error fell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.report.comparison_text import in_words, unit_behind, verdict_words

if TYPE_CHECKING:
    from agent.workbench.comparison import Comparison
    from agent.workbench.step import Step

NUMBERS = 2
"""Parameters of an effect that are shown, the first ones: the others are in the table."""


def headline(found: Comparison) -> str:
    """Return the line; where no effect was added, the verdict in words."""
    if not found.steps:
        return f"not testable: {found.reason}"
    last = found.steps[-1]
    if not last.effects:
        return verdict_words(found.verdict, found)
    effects = "; ".join(effect_words(last, each) for each in last.effects)
    return f"{effects}; held-out error {error_change(found):+.0f} %"


def effect_words(step: Step, effect: str) -> str:
    """Return an effect of a model with its first numbers and their 90 % intervals."""
    own = [each for each in step.parameters if each.name.startswith(f"{effect}.")]
    lasting = [each for each in own if not each.of_record] or own
    numbers = []
    for each in lasting[:NUMBERS]:
        name = "" if len(lasting) == 1 else f"{symbol(each.name.partition('.')[2])} "
        numbers.append(f"{name}{each.value:.4g}{unit_behind(each)} ({each.low:.4g} to {each.high:.4g})")
    return " ".join((in_words(effect), ", ".join(numbers))).rstrip()


def symbol(parameter: str) -> str:
    """Return a parameter of an effect in words; S and J as everybody writes them."""
    return parameter.upper() if len(parameter) == 1 else in_words(parameter)


def error_change(found: Comparison) -> float:
    """Return by how much the held-out RMSE of the last step differs from that of the base, %."""
    return 100 * (found.steps[-1].held_out.rmse / found.steps[0].held_out.rmse - 1)


def capital(words: str) -> str:
    """Return a sentence with a capital letter at its begin."""
    return words[:1].upper() + words[1:]
