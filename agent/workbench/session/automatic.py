"""Goes on by itself: adds what the record confirms, and takes out what a later effect has made idle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.workbench.evidence import far_likelier
from agent.workbench.hypotheses import CONFIRMED
from agent.workbench.paired_blocks import lowers_error
from agent.workbench.residual.holm import LEVEL
from agent.workbench.step import Verdict

if TYPE_CHECKING:
    from agent.workbench.hypotheses import Decision
    from agent.workbench.session.bench import Bench

MOST_EFFECTS = 4


def add_all_confirmed(bench: Bench) -> None:
    """Add effects until no more is confirmed; after each, test the earlier ones again."""
    while len(bench.step.effects) < MOST_EFFECTS:
        decision = bench.candidates()
        if decision.effect is None:
            added = _add_beyond(bench)
        elif decision.effect in {each.dropped for each in bench.staircase()}:
            break
        elif decision.kind in CONFIRMED:
            added = bool(bench.add(decision.effect))
        else:
            added = _add_both(bench, decision)
        if not added:
            break
        _drop_idle(bench)


def _add_beyond(bench: Bench) -> bool:
    """Add what mends a failure but lowers the error by little, if the record confirms another effect beyond.

    A lag that the model lacks is most of what its innovations say, and hides what is slow: of a heater beside
    a second one 0.4 % of the error are the lag's, and 88 % those of the other heater. Returns whether the
    record does.
    """
    found = bench.tried()
    verdict = bench.verdict_on(found)
    if verdict.effect is None or len(bench.step.effects) > MOST_EFFECTS - 2:
        return False
    bench.take(found.models[verdict.effect], verdict, added=verdict.effect)
    beyond = bench.candidates()
    if beyond.effect is None or beyond.kind not in CONFIRMED:
        bench.undo()
        return False
    bench.add(beyond.effect)
    return True


def _add_both(bench: Bench, decision: Decision) -> bool:
    """Add the best effect and a rival that it cannot be distinguished from, if the record holds both.

    Returns whether there is such a rival.
    """
    found = bench.tried()
    for name in decision.rivals:
        best, rival = str(decision.effect), bench.effect(name)
        both = bench.trials.both(bench.step, found, best, rival)
        if both is not None:
            family = bench.effect(best).family
            bench.take(found.models[best], Verdict("confirmed", best, family), added=best)
            both = bench.trials.with_all_harmonics(both)
            bench.take(both, Verdict("confirmed", name, rival.family), added=name)
            return True
    return False


def _drop_idle(bench: Bench) -> None:
    """Take out earlier effects that reduce the held-out error no more, nor make the record far likelier."""
    for name in bench.step.effects[:-1]:
        bench.trials.progress(f"without {name}", 0, 1)
        rest = bench.trials.without(bench.step.fit, name)
        needed = lowers_error(rest.held_out.losses, bench.step.held_out.losses, LEVEL)
        if not needed and not far_likelier(rest, bench.step, bench.record):
            bench.take(rest, dropped=name)
