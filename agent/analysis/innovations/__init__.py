"""How much more likely a record is if its valve sticks: the free run on the whole band, with its noise.

A load that wanders moves OP while PV stands, and so does a dead band; the error of a free run cannot tell
them apart. Its innovations can: what of the error of PV could not be foreseen from the error before, if it
wanders. A slip comes at an instant that only the valve knows; a load leaves the same innovations with and
without a sticking valve. See docs/methods/innovations.md.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.innovations.load_step import with_load_step
from agent.analysis.innovations.load_wave import with_load_wave
from agent.analysis.innovations.noise_models import noise_models
from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.valve_search import best_valve
from agent.analysis.innovations.whitened import Fit, log_likelihood
from agent.analysis.innovations.would_show import chance_to_show
from agent.analysis.quantify.free_run.found import SLIDES_BELOW
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.least_step import op_range_of
from agent.analysis.record.resolution import dithered
from agent.analysis.record.spans import in_spans_of
from agent.identify.objective import S, valve_position

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agent.analysis.record.recording import FloatArray, LoopHints, LoopWindow
    from agent.analysis.results import Quantification
    from agent.identify.problem import Problem

LEAST_S = 0.02
"""S below this share of the OP span takes noise off OP, which any record likes a little."""


NOTHING = 2.0
"""Nats that are not worth the search for a step of the load."""


class Told(NamedTuple):
    """The valve that ``free_run`` found, OP less its least value in OP spans."""

    s: float
    j: float
    stem: FloatArray | None
    """How it moved, (n,); None where that is not known."""


class InnovationsSay(NamedTuple):
    """What the innovations of a record say of its valve."""

    log_likelihood_ratio: float
    """Of how much more likely the record is with a sticking valve than without, nats, >= 0."""
    would_show: float | None
    """How likely the record would show a valve that sticks, 0 to 1; None: not known."""
    wave: bool = False
    """Whether a wave of the load makes the record at least as likely as a valve that sticks."""


NOTHING_SAID = InnovationsSay(0.0, None)


def innovations_say(window: LoopWindow, found: Quantification) -> InnovationsSay:
    """Return how much more likely the record is with a sticking valve, and whether it would be.

    Both models see the same processes and choose their own noise. The load of the sound one may step once, or
    be one wave, as that of a sticking one may be then. Valves: the one that ``found`` has, whatever
    its decision, and those of a search of its own.

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
    sticking = list(_sticking(told(window, found), whitened, window.hints))
    best = max((log_likelihood(fit, behind[fit.noise]) for fit, behind in sticking), default=sound)
    gains, wave = best - sound > NOTHING, -math.inf
    if gains or (found.evidence or 0.0) >= SLIDES_BELOW:
        wave = with_load_wave(linear, whitened, window.hints)
    if gains:
        sound = max(sound, with_load_step(linear, whitened))
    if wave > sound:
        sound = wave  # the load of a sticking valve may then have one as well
        stems = [each for each in sticking if each[1] is not whitened]
        best = max([best, *(with_load_wave(*each, window.hints) for each in stems)])
    low, high = op_range_of(window)
    op_range = (high - low) / window.op_span
    shows = chance_to_show(linear, whitened[linear.noise], op_range) if op_range > 0 else None
    return InnovationsSay(max(0.0, best - sound), shows, wave >= max(sound, best))


def told(window: LoopWindow, found: Quantification) -> Told | None:
    """Return the valve of an answer; None where it has none."""
    if found.stiction is None or not found.stiction.s.value > 0:
        return None
    moved = found.model_mv if found.sticking is None else found.sticking.mv
    stem = None if moved is None else np.ascontiguousarray((moved - np.nanmin(window.op)) / window.op_span)
    return Told(found.stiction.s.value / window.op_span, found.stiction.j.value / window.op_span, stem)


def _sticking(
    valve: Told | None, whitened: Sequence[Problem], hints: LoopHints
) -> Iterator[tuple[Fit, Sequence[Problem]]]:
    """Yield the best fit of the valve that was found and of that of a search, with the record behind it.

    A stem counts whether it turns or not: where it stood while OP moved is told by the likelihood, and a load
    that did the same is in the innovations of both models. With its stem known, each valve gets the processes
    that the model without one may have.
    """
    stems = [] if valve is None or valve.s < LEAST_S or valve.stem is None else [valve.stem]
    searched = best_valve(whitened, hints, None if valve is None else (valve.s, valve.j))
    if searched is not None and searched.candidate[S] >= LEAST_S:
        yield searched, whitened
        stems.append(valve_position(searched.candidate, whitened[searched.noise]))
    for stem in stems:
        moved = [each._replace(op=stem[: len(each.op)]) for each in whitened]
        fit = best_process(moved, hints)
        if fit is not None:
            yield fit, moved
