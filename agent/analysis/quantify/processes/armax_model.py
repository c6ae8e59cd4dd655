"""An ARMAX behind the valves that the search with plain least squares found best.

Extended least squares costs fifty times as much as the ARX of ``joint_fit``, whose error ranks the valves
well enough to leave most of them out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.processes.armax import fit_armax, free_run
from agent.analysis.quantify.processes.model_error import mean_squared_error
from agent.analysis.quantify.processes.output_error import INTEGRATOR, plausible
from agent.analysis.quantify.valves.joint_fit import Model
from agent.analysis.quantify.valves.valve_law import stem_position, valve_position
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.quantify.valves.joint_fit import CentredRecord
    from agent.analysis.record.recording import FloatArray

KEPT_VALVES = 30
"""Valves behind which an ARMAX is put."""
KEPT_DELAYS = 2
"""Delays of each structure that are tried behind a sticking valve."""


def best_valves(
    record: CentredRecord,
    bands: FloatArray,
    delays: NDArray[np.int64],
    structures: tuple[int, ...],
    walk: float,
) -> Model | None:
    """Return the best model over the valves that plain least squares ranks first, or None.

    Args:
        record: The record.
        bands: f_S and f_D of the valves, OP units, shape (k, 2).
        delays: Delays to try, samples, shape (d,).
        structures: Structures to try.
        walk: Step of the bias, see ``fit_armax``.
    """
    errors = record.errors(bands, delays, structures)
    ranking = np.argsort(errors.min(axis=(1, 2)), kind="stable")[:KEPT_VALVES]
    models = [
        _behind_valve(record, bands[each], errors[each], delays, structures, walk, KEPT_DELAYS)
        for each in ranking
    ]
    return min((model for model in models if model), key=lambda model: model.error, default=None)


def without_stiction(
    record: CentredRecord, delays: NDArray[np.int64], structures: tuple[int, ...], walk: float
) -> Model | None:
    """Return the best model without stiction over all delays, None where none is plausible."""
    none = np.zeros((1, 2))
    errors = record.errors(none, delays, structures)[0]
    return _behind_valve(record, none[0], errors, delays, structures, walk, None)


def better(best: Model | None, linear: Model | None, delays: NDArray[np.int64]) -> Model | None:
    """Return the model without stiction where it is the better one and its delay one of ``delays``."""
    if best is None or linear is None or linear.process.delay not in delays:
        return best
    return linear if linear.error <= best.error else best


def _behind_valve(
    record: CentredRecord,
    bands: FloatArray,
    errors: FloatArray,
    delays: NDArray[np.int64],
    structures: tuple[int, ...],
    walk: float,
    kept: int | None,
) -> Model | None:
    """Return the best ARMAX behind one valve.

    Of each structure and delay the noise model with the least AIC counts; between these the error of the
    free run decides, eta included. ``errors`` are those by plain least squares, shape (structures, delays);
    ``kept`` delays of each structure are tried, None: all.
    """
    f_s, f_d = float(bands[0]), float(bands[1])
    mv = valve_position(record.op, f_s, f_d, record.law)
    best: Model | None = None
    for structure, row in zip(structures, errors, strict=True):
        noise_orders = range(2 if structure == INTEGRATOR else 3)
        for delay in delays[np.argsort(row, kind="stable")[:kept]]:
            fits = [fit_armax(mv, record.pv, int(delay), structure, each, walk) for each in noise_orders]
            likely = min(fits, key=lambda fit: fit.aic)
            if not plausible(likely.process, record.gain_sign):
                continue
            pv = free_run(likely, mv, record.pv)
            error = mean_squared_error(pv, record.pv)
            if best is None or error < best.error:
                stem = stem_position(record.op, f_s, f_d, record.op[np.isfinite(record.op)][0], record.law)
                best = Model(FrictionBands(f_s, f_d), structure, likely.process, stem, pv, error)
    return best
