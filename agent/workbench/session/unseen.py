"""What a comparison could not have seen, in words: too small, too fast, too slow, not excited, not tried."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.workbench.library import applies, missing
from agent.workbench.nuisance import SLOWEST

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.workbench.session.bench import Bench


def unseen(bench: Bench, smallest_percent: float | None) -> tuple[str, ...]:
    """Return one statement for each limit of what this record and this library can show.

    Args:
        bench: A session with at least its base.
        smallest_percent: As in ``Comparison``.
    """
    return tuple(_statements(bench, smallest_percent))


def _statements(bench: Bench, smallest_percent: float | None) -> Iterator[str]:
    facts = bench.record.facts
    if bench.part is not None:
        yield bench.part.words
    if smallest_percent is None:
        yield "small effects: too few samples in a row count to know how small"
    else:
        least = f"{smallest_percent:.0f} %"
        yield f"an effect of less than {least} of the squared error of the last model"
    yield (
        f"what happens outside OP from {facts.op_low:.4g} to {facts.op_high:.4g}: "
        "a limit, a dead zone or another slope of the valve there"
    )
    yield f"anything faster than two samples ({2 * facts.ts:.4g} s)"
    slowest = f"{SLOWEST * facts.period:.4g} s"
    yield f"a drift slower than {slowest}: level and slow drift are removed with every model"
    for shown in bench.trials.shown_on(bench.step, bench.library):
        if shown.why_not is not None:
            yield f"{shown.effect}: {shown.why_not}"
    outside = [each.name for each in bench.installed if not applies(each, bench.base)]
    if outside:
        yield f"{', '.join(outside)}: not possible on the base {bench.base.name}"
    for each in bench.trials.left_out.values():
        yield f"{each}; it was left out"
    known = {each.name for each in bench.library}
    left_out = [each.name for each in bench.installed if each.name not in known and applies(each, bench.base)]
    if left_out:
        yield f"{', '.join(left_out)}: taken out of the library"
    open_to = {each.name for each in missing(bench.step.fit.model, bench.library)}
    taken = [each for each in known - open_to if each not in bench.step.effects]
    if taken:
        yield f"{', '.join(sorted(taken))}: the model has another effect of the same family"
