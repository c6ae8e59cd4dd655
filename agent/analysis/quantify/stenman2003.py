"""Stiction by the jumps of the valve: Stenman, Gustafsson and Forsman (2003).

Int. J. of Adaptive Control and Signal Processing 17:625. The valve either rests or jumps to OP, and the most
probable sequence of that is sought beside a process model (see ``mode_sequence``). The valve sticks where
such a sequence is more likely than a valve that always follows OP. [MEM]: a reconstruction from
``methods.md`` 1.6, the paper's text was not at hand.

Ours: the process runs free as in ``output_error``; it starts as the best one behind the one-parameter valve
of a grid and is fitted anew to each sequence as long as that helps; d is the force |u(t) - x(t-1)| at jumps
against the one before, where it is S = f_S + f_D also for a valve with kinetic friction. Large jumps count
more, since small ones stand for noise: the median is weighted by the force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.mode_sequence import mode_sequence
from agent.analysis.quantify.processes.model_error import mean_squared_error
from agent.analysis.quantify.processes.output_error import fit_process, plausible
from agent.analysis.quantify.srinivasan2005 import one_parameter
from agent.analysis.quantify.valves.joint_fit import (
    NO_STICTION,
    CentredRecord,
    Model,
    answer,
    failed,
    free_delays,
    lack,
    structures_to_try,
)
from agent.analysis.quantify.valves.least_fit import undecided_below_least_fit
from agent.analysis.quantify.valves.valve_law import HE
from agent.physics.processes.arx import simulate_arx
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import Quantification

THRESHOLD = 2.0
"""Evidence above which the valve is said to stick. A free sequence follows PV better than any law, so the
threshold is higher than that of the others: 3 of 160 simulated loops without stiction and 36 of 40 with it
exceed it (``random_plants``, seeds 0 to 39)."""
JUMPS = 0.02
"""Prior probability of a jump at a sample: jumps are sparse."""
PRICE = 2 * math.log((1 - JUMPS) / JUMPS)
"""What a jump costs in -2 log likelihood."""
LEAST_NOISE = 1e-9
"""Share of the variance of PV that counts as noise even of a perfect fit."""
STARTS = 6
"""Processes that are tried as the first one."""
ROUNDS = 5
"""Sequences in turn with processes at most."""


@dataclass(frozen=True, slots=True)
class Stenman2003Quantifier:
    """Most probable sequence of jumps, process in free run."""

    name: str = "stenman2003"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; where that is not possible, ``failure`` states why."""
        missing = lack(window)
        if missing is not None:
            return failed(self.name, missing)
        record = CentredRecord.of(window, HE)
        structures = structures_to_try(window)
        anywhere = free_delays(window, structures)
        delays = anywhere if window.hints.delay is None else np.array([window.hints.delay])
        linear = record.best_model(NO_STICTION, np.union1d(anywhere, delays), structures)
        best = _best_sequence(record, window.op_span, delays, structures)
        found = undecided_below_least_fit(answer(self.name, window, record, best, linear, THRESHOLD))
        if best is None or found.decision == "no_stiction" or found.evidence is None:
            return found
        gained = len(window) * math.log(found.evidence)
        paid = PRICE * np.count_nonzero(np.diff(best.mv))
        return found if gained > paid else replace(found, decision="no_stiction")


def force_at_jumps(op: FloatArray, stem: FloatArray) -> float:
    """Return the force at jumps against the one before, the median weighted by itself; 0 without one.

    Args:
        op: Controller output, OP units, shape (n,).
        stem: Positions of the valve, OP units, shape (n,).
    """
    steps = np.diff(stem)
    jumps = np.flatnonzero(steps)
    against = jumps[1:][np.sign(steps[jumps[1:]]) != np.sign(steps[jumps[:-1]])]
    forces = np.sort(np.abs(op[against + 1] - stem[against]))
    weights = np.cumsum(forces)
    return float(forces[np.searchsorted(weights, weights[-1] / 2)]) if forces.size else 0.0


def _best_sequence(
    record: CentredRecord, largest: float, delays: NDArray[np.int64], structures: tuple[int, ...]
) -> Model | None:
    """Return the best model from several starts, None where no process is plausible."""
    bands = one_parameter(largest)
    errors = record.errors(bands, delays, structures)
    valves = errors.argmin(axis=0)
    order = np.argsort(errors.min(axis=0), axis=None, kind="stable")[:STARTS]
    models = []
    for row, column in zip(*np.unravel_index(order, valves.shape), strict=True):
        start = record.best_model(bands[valves[row, column]], delays[[column]], (structures[row],))
        if start is not None:
            models.append(_alternate(record, start))
    return min(models, key=lambda model: model.error, default=None)


def _alternate(record: CentredRecord, model: Model) -> Model:
    """Seek the sequence behind the process and the process behind the sequence, as long as that helps."""
    for _ in range(ROUNDS):
        known = np.where(np.isnan(record.op), np.nan, model.mv)
        level = (model.process.b1 + model.process.b2) * float(np.nanmean(known))
        process = model.process._replace(bias=model.process.bias - level)
        noise = max(model.error, LEAST_NOISE * record.variance)
        stem = mode_sequence(record.op, record.pv, process, noise, PRICE)
        better = _behind_stem(record, stem, model)
        if better is None or better.error >= model.error:
            break
        model = better
    return model


def _behind_stem(record: CentredRecord, stem: FloatArray, model: Model) -> Model | None:
    """Return the process of the same structure and delay behind these positions, None where implausible."""
    known = np.where(np.isnan(record.op), np.nan, stem)
    if np.isnan(known).all():
        return None
    mv = known - np.nanmean(known)
    process = fit_process(mv, record.pv, model.process.delay, model.structure)
    if not plausible(process, record.gain_sign):
        return None
    pv = simulate_arx(process, mv, record.pv)
    bands = FrictionBands(force_at_jumps(record.op, stem), 0.0)
    return Model(bands, model.structure, process, stem, pv, mean_squared_error(pv, record.pv))
