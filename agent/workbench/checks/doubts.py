"""What speaks against an effect that would be named; computed only then, for some of it takes long.

A check rejects an effect, or lowers it to a suggestion, or says what the model lacks beside it. What is
rejected hands the verdict to nothing that is far less likely (``hypotheses.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from agent.workbench.checks.lacking import DYNAMICS, is_trifle, lacks_words, larger_dynamics
from agent.workbench.checks.other_event import begins_with_op, is_only_another_level
from agent.workbench.checks.own_cycle import WORDS as OWN_CYCLE
from agent.workbench.checks.own_cycle import may_be_loops_own
from agent.workbench.checks.pairs import (
    as_likely_words,
    far_likelier_than,
    is_as_likely,
    is_beside,
    likeliest_pair,
)
from agent.workbench.evidence import far_likelier
from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.state_dependence import (
    failing,
    fails,
    removed_by,
    state_dependence,
    still_fails,
)

if TYPE_CHECKING:
    from agent.physics.effect import Effect
    from agent.workbench.checks.pairs import Pair
    from agent.workbench.evidence import Evidence
    from agent.workbench.record import Record
    from agent.workbench.step import Step
    from agent.workbench.trial import Optimum, Tried


UNLIKELY = "the record is far more likely with another effect"
OTHER_EVENT = "what happened was of another kind"
STANDS_FOR_OP = "it happens where PV answers moves of OP: it stands for a part of that answer"
"""What rejects an effect although it lowers the held-out error, in words for the user."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """What speaks against one effect, in words; None where nothing does."""

    rejects: str | None = None
    lowers: str | None = None
    """What makes it a suggestion at most."""
    lacks: str | None = None
    """What the model still lacks with it, though it is plainly there."""
    pair: Pair | None = None
    """Of effects that reject it, an event."""


@dataclass(frozen=True)
class Tries:
    """What was tried on top of one model, and what can be tried beside that."""

    smaller: Step
    models: Mapping[str, Tried]
    """By the effect that was added, like ``found``."""
    found: Mapping[str, Evidence]
    record: Record
    together: Callable[[Step | Optimum, Effect], Optimum]
    """Tries an effect on top of one of the models, or of the smaller one."""
    answering: Callable[[Optimum], Iterable[Effect]]
    """What acts on OP all the time and the innovations hint at beside an effect, the best first."""
    screened: int
    """How many effects were scored, of which ``models`` were fitted: each was a try."""

    @cached_property
    def pair(self) -> Pair | None:
        """The likeliest two effects that act on OP; fitted only where an event would be named."""
        return likeliest_pair(
            self.found, self.models, self.answering, self.together, self.record, self.screened
        )

    def doubt(self, name: str) -> Doubt:
        """Return what speaks against an effect."""
        event = self._doubt_of_event(name) if self.found[name].once else Doubt()
        if event.rejects is not None:
            return event
        lacks, lowers = self._lacks(name)
        if self.found[name].once and lowers is not None:
            return Doubt(lowers)
        if may_be_loops_own(self.smaller.predicts, self.models[name].fit):
            lowers = OWN_CYCLE
        return Doubt(lowers=event.lowers or lowers, lacks=lacks)

    def _doubt_of_event(self, name: str) -> Doubt:
        """Return what speaks against what seems to have happened once.

        A load knows nothing of OP; another answer to OP does more than another level; and two effects that go
        on all the time may do as much (``pairs.py``).
        """
        evidence, predicts, stands_for_op = self.found[name], self.models[name].predicts, None
        if predicts is not None:
            if evidence.answers and is_only_another_level(*predicts):
                return Doubt(OTHER_EVENT)
            if not evidence.answers and begins_with_op(*predicts) < LEVEL:
                stands_for_op = STANDS_FOR_OP
        pair = self.pair
        if pair is not None and far_likelier_than(pair, evidence):
            return Doubt(UNLIKELY, pair=pair)
        if pair is None or stands_for_op is not None:
            return Doubt(stands_for_op)
        if is_as_likely(pair, evidence) and not is_beside(
            pair, self.models[name], self.together, self.record
        ):
            return Doubt(lowers=as_likely_words(pair))
        return Doubt()

    def _lacks(self, name: str) -> tuple[str | None, str | None]:
        """Return what a model still lacks with an effect that is plainly there, or what lowers the effect.

        It is what made the smaller model fail, and is still there. A wave that goes on all the time is seen
        by itself, whatever else is missing. What happened once and knows nothing of OP must leave nothing
        that hangs on OP. The likelihood of an event is too kind under a load that wanders, so that one that
        leaves something stands for another cause, and hides none.
        """
        evidence, predicts = self.found[name], self.models[name].predicts
        remains = {} if predicts is None else state_dependence(*predicts)
        left: set[str] = set()
        if evidence.answers:
            removed = removed_by(self.smaller.predicts, predicts)
            left = still_fails(self.smaller.estimate.dependence, remains, removed)
        elif evidence.once:
            left = failing(remains)
        if not left:
            return None, None
        words = lacks_words(left)
        plain = self._is_explained(name, left) or is_trifle(name, self.models[name], self.found)
        return (words, None) if plain else (None, words)

    def _is_explained(self, name: str, left: set[str]) -> bool:
        """Whether what an effect leaves on some axes has another cause."""
        if not self.found[name].once and not self.smaller.fit.model.base.linear:
            return True  # the law of a balance is a guess: what remains is named, and may be its own
        family = self.found[name].family
        kin = {each for each, one in self.found.items() if one.family == family}
        return left <= DYNAMICS and any(
            self._beside_dynamics(name, other) for other in larger_dynamics(self.models, kin)
        )

    def _beside_dynamics(self, name: str, other: str) -> bool:
        """Whether an effect is needed beside larger dynamics, the second, and both explain the record."""
        larger = self.together(self.models[name], self.models[other].fit.model.effects[-1])
        predicts = larger.predicts
        if predicts is None or not far_likelier(self.models[other], larger, self.record):
            return False
        return not fails(state_dependence(*predicts))
