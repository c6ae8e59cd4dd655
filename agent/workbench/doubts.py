"""What speaks against an effect that would be confirmed; computed only then, for some of it takes long."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from agent.workbench.checks.lacking import (
    DYNAMICS,
    is_likeliest_by_far,
    is_trifle,
    lacks_words,
    larger_dynamics,
)
from agent.workbench.checks.own_cycle import WORDS as OWN_CYCLE
from agent.workbench.checks.own_cycle import may_be_loops_own
from agent.workbench.checks.pairs import as_likely_words, far_likelier_than, is_as_likely
from agent.workbench.other_event import begins_with_op, is_another_gain, is_only_another_level
from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.state_dependence import failing, removed_by, state_dependence, still_fails

if TYPE_CHECKING:
    from agent.workbench.checks.pairs import Pair
    from agent.workbench.decision import Decision
    from agent.workbench.evidence import Evidence
    from agent.workbench.residual.state_dependence import Dependence
    from agent.workbench.step import Step
    from agent.workbench.trial import Tried


ANSWERS = "the innovations do not fall: it repeats what the controller does"
UNLIKELY = "the record is far more likely with another effect"
STANDS_FOR_ANOTHER = "with it the model still fails as before: it stands for another cause"
BY_CHANCE = "the innovations show no such event: one as large appears by chance"
OTHER_EVENT = "what happened was of another kind"
STANDS_FOR_OP = "it happens where PV answers moves of OP: it stands for a part of that answer"
"""What rejects an effect although it lowers the held-out error, in words for the user."""


@dataclass(slots=True)
class Doubts:
    """Of the candidates on top of one model."""

    smaller: Step
    models: Mapping[str, Tried]
    """By the effect that was added, like ``found``."""
    found: Mapping[str, Evidence]
    beside_dynamics: Callable[[str, str], bool]
    """Whether an effect is needed beside larger dynamics, the second, and both explain the record."""
    beside_pair: Callable[[str, Pair], bool]
    """Whether an event explains another part of the record than two effects do."""
    pair: Callable[[], Pair | None]
    """The likeliest two effects that act on OP; fitted only where an event would be confirmed."""
    objections: dict[str, str] = field(default_factory=dict)
    """What rejects an effect, in words; ``object_to`` adds to it."""
    lowered: dict[str, str] = field(default_factory=dict)
    """What makes an effect a suggestion at most, in words."""
    lacks: dict[str, str] = field(default_factory=dict)
    """What the model still lacks with an effect that is plainly there, in words."""
    likelier_pair: Pair | None = None
    """That rejected an event."""
    _seen: set[str] = field(default_factory=set)
    _dependences: dict[str, Mapping[str, Dependence]] = field(default_factory=dict)

    def object_to(self, decision: Decision) -> bool:
        """Add what speaks against a decision's effect and its rivals; return whether anything new does."""
        rivals = (str(decision.effect), *decision.rivals)
        new = [each for each in rivals if each not in self._seen]
        self._seen.update(new)
        before = len(self.objections)
        for each in new:
            if self._stands_for_another(each):
                self.objections[each] = STANDS_FOR_ANOTHER
            if may_be_loops_own(self.smaller.predicts, self.models[each].fit):
                self.lowered[each] = OWN_CYCLE
            if self._is_another_event(each):
                self.objections[each] = OTHER_EVENT
            elif self.found[each].once and each not in self.objections:
                if self._stands_for_op(each):
                    self.objections[each] = STANDS_FOR_OP
                self._compare_with_pair(each)
        return len(self.objections) > before

    def _compare_with_pair(self, name: str) -> None:
        """Reject an event where two effects are far likelier; lower it where they may stand in its place."""
        pair = self.pair()
        if pair is None:
            return
        if far_likelier_than(pair, self.found[name]):
            self.objections[name] = UNLIKELY
            self.likelier_pair = pair
        elif is_as_likely(pair, self.found[name]) and not self.beside_pair(name, pair):
            self.lowered[name] = as_likely_words(pair)

    def _stands_for_another(self, name: str) -> bool:
        """Whether what made the smaller model fail is still there with an effect, and no other explains it.

        A wave that goes on all the time is seen by itself, whatever else is missing. What happened once and
        knows nothing of OP must leave nothing that hangs on OP.
        """
        evidence = self.found[name]
        left = self._leaves(name) if evidence.answers else set()
        if evidence.once and not evidence.answers:
            left = failing(self._dependence(name))
        if not left:
            return False
        explained = self._is_explained(name, left)
        if not explained and not is_likeliest_by_far(name, self.found):
            return True
        plain = explained or is_trifle(name, self.models[name], self.found)
        (self.lacks if plain else self.lowered)[name] = lacks_words(left)
        return False

    def _is_explained(self, name: str, left: set[str]) -> bool:
        """Whether what an effect leaves on some axes has another cause."""
        if not self.found[name].once and not self.smaller.fit.model.base.linear:
            return True  # the law of a balance is a guess: what remains is named, and may be its own
        return left <= DYNAMICS and any(
            self.beside_dynamics(name, other) for other in self._larger_dynamics(name)
        )

    def _larger_dynamics(self, name: str) -> tuple[str, ...]:
        family = self.found[name].family
        kin = {each for each, one in self.found.items() if one.family == family}
        return larger_dynamics(self.models, kin)

    def _stands_for_op(self, name: str) -> bool:
        """Whether an event that knows nothing of OP is where PV answers moves of OP."""
        predicts = self.models[name].predicts
        if self.found[name].answers or predicts is None:
            return False
        return begins_with_op(*predicts) < LEVEL

    def _is_another_event(self, name: str) -> bool:
        """Whether what seems to have happened once was of another kind.

        A load does not do what another gain does; another answer to OP does more than another level.
        """
        evidence, predicts = self.found[name], self.models[name].predicts
        if not evidence.once or predicts is None:
            return False
        return is_only_another_level(*predicts) if evidence.answers else is_another_gain(*predicts)

    def _leaves(self, name: str) -> set[str]:
        """Return the axes on which what made the smaller model fail is still there, with an effect."""
        removed = removed_by(self.smaller.predicts, self.models[name].predicts)
        return still_fails(self.smaller.estimate.dependence, self._dependence(name), removed)

    def _dependence(self, name: str) -> Mapping[str, Dependence]:
        """Return what each axis shows of the model with an effect, once; empty without predictions."""
        if name not in self._dependences:
            predicts = self.models[name].predicts
            self._dependences[name] = {} if predicts is None else state_dependence(*predicts)
        return self._dependences[name]
