"""How much more likely a record is if its valve sticks: the free run on the whole band, with its noise.

A load that wanders moves OP while PV stands, and so does a dead band; the error of a free run cannot
distinguish them. Its innovations can: what of the error of PV could not be foreseen from the error before, if
it wanders. A slip comes at an instant that only the valve knows; a load leaves the same innovations with and
without a sticking valve. See docs/methods/innovations.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from agent.analysis.evidence.weighing import ENOUGH_LIKELIHOOD
from agent.analysis.innovations.load_step import with_load_step
from agent.analysis.innovations.load_wave import with_load_wave
from agent.analysis.innovations.noise_models import noise_models
from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.stems import stems_of, valve_of, with_scatter
from agent.analysis.innovations.whitened import log_likelihood
from agent.analysis.innovations.would_show import chance_to_show
from agent.analysis.quantify.free_run.found import SLIDES_BELOW
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.least_step import op_range_of
from agent.analysis.record.resolution import dithered
from agent.analysis.record.spans import in_spans_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.innovations.stem import StickingStem
    from agent.analysis.innovations.whitened import Fit
    from agent.analysis.record.recording import LoopHints, LoopWindow
    from agent.analysis.results import Quantification
    from agent.identify.problem import Problem

NOTHING = 2.0
"""Nats that are not worth the search for a step of the load."""


class InnovationsSay(NamedTuple):
    """What the innovations of a record say of its valve."""

    log_likelihood_ratio: float
    """Of how much more likely the record is with a sticking valve than without, nats, >= 0."""
    would_show: float | None
    """How likely the record would show a valve that sticks, 0 to 1; None: not known."""
    wave: bool = False
    """Whether a wave of the load makes the record at least as likely as a valve that sticks."""
    slip_scatter: float | None = None
    """Standard deviation of the logarithm of S from slip to slip; None where one S explains them as well."""


NOTHING_SAID = InnovationsSay(0.0, None)


def innovations_say(window: LoopWindow, found: Quantification) -> InnovationsSay:
    """Return how much more likely the record is with a sticking valve, and whether it would be.

    Both models see the same processes and choose their own noise. The load of the sound one may step once, or
    be one wave, as that of a sticking one may be then. Valves: the one that ``found`` has, whatever
    its decision, those of a search of its own, and one whose friction scatters from slip to slip.

    Args:
        window: The record.
        found: Answer of ``free_run`` on it.
    """
    in_spans = in_spans_of(window)
    if in_spans is None:
        return NOTHING_SAID
    in_spans = replace(in_spans, pv=dithered(in_spans.pv))
    problem = pose(in_spans)
    if isinstance(problem, str):
        return NOTHING_SAID
    whitened = noise_models(in_spans, problem)
    linear = best_process(whitened, window.hints)
    if linear is None:
        return NOTHING_SAID
    sound = log_likelihood(linear, whitened[linear.noise])
    record = _Record(whitened, window.hints, linear, sound, (found.evidence or 0.0) >= SLIDES_BELOW)
    stems = list(stems_of(valve_of(window, found), whitened, window.hints))
    ratio, wave, scatter = *_against_load(stems, record), None
    if ratio < ENOUGH_LIKELIHOOD:
        slips = with_scatter(stems, whitened, window.hints)
        if slips is not None and slips.stem.likelihood > _likeliest(stems, sound) + NOTHING:
            ratio, wave, scatter = *_against_load([*stems, slips.stem], record), slips.scatter
    low, high = op_range_of(window)
    op_range = max((high - low) / window.op_span, 1.0)  # where it is not known, the least that it can be
    shows = chance_to_show(linear, whitened[linear.noise], op_range)
    return InnovationsSay(ratio, shows, wave, scatter)


@dataclass(frozen=True)
class _Record:
    """What a valve that sticks is compared with."""

    whitened: Sequence[Problem]
    """The record behind each filter."""
    hints: LoopHints
    linear: Fit
    """The best process without a valve."""
    sound: float
    """Its log likelihood, nats, less a constant."""
    moves: bool
    """Whether the free run is closer with a valve."""

    @cached_property
    def wave(self) -> float:
        """Return the log likelihood without a valve where the load is one wave, nats, less a constant."""
        return with_load_wave(self.linear, self.whitened, self.hints)


def _against_load(stems: Sequence[StickingStem], record: _Record) -> tuple[float, bool]:
    """Return how much more likely the record is with the likeliest stem than with a load, nats, >= 0.

    And whether the load is a wave that makes it at least as likely as a valve.
    """
    best, sound = _likeliest(stems, record.sound), record.sound
    gains, wave = best - sound > NOTHING, -math.inf
    if gains or record.moves:
        wave = record.wave
    if gains:
        sound = max(sound, with_load_step(record.linear, record.whitened))
    if wave > sound:
        sound = wave  # the load of a sticking valve may then have one as well
        waves = (with_load_wave(each.fit, each.behind, record.hints) + each.price for each in stems)
        best = max([best, *waves])
    return max(0.0, best - sound), wave >= max(sound, best)


def _likeliest(stems: Sequence[StickingStem], sound: float) -> float:
    return max((each.likelihood for each in stems), default=sound)
