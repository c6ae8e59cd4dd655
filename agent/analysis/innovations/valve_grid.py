"""Every (S, J/S, rest) on a grid, scored by a bank of processes: where a sticking valve may be hidden.

The grid of the search (``agent.identify.search.grid``) takes the first slip to lie where a limit cycle slips
again and again. Here the stem may stand anywhere that its friction lets it stand, and need not ever turn: a
record of few moves shows one stand, and that alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.identify.bank import Bank
from agent.identify.bank_score import best_share, room_for
from agent.identify.search.grid import meets
from agent.jit import kernel
from agent.physics.valves.damped_stem import stem_at, stem_motion, strokes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray

ALIKE = 1e-3
"""Positions, over f_S, by which two stems may differ after a quarter and half of the record and at its end
and be one: stems soon forget where they rested."""


@kernel
def scan_rests(
    bank: Bank,
    stem: FloatArray,
    s_values: FloatArray,
    j_ratios: FloatArray,
    rest_step: float,
    delays: NDArray[np.int64],
) -> tuple[FloatArray, NDArray[np.int64], FloatArray]:
    """Return the best share of PV over all rests, (S, J), with its place in the bank and its rest.

    Args:
        bank: The record before many processes.
        stem: Damping, supply and rest of the stem (``damped_stem``), (3,).
        s_values: S, OP units.
        j_ratios: J/S.
        rest_step: Step of the position in which the stem rests before the record, OP units.
        delays: Delays of the bank, blocks, ascending.
    """
    shape = (s_values.size, j_ratios.size)
    scores, places, rests = np.zeros(shape), np.zeros(shape, np.int64), np.zeros(shape)
    n = bank.op.size
    room = room_for(bank, delays)
    looks = np.array([max(1, n // 16), max(1, n // 8), n // 4 + 1])
    sights = np.array([n // 4, n // 2, n - 1])
    motion = stem_motion(stem[0], stem[1], stem[2])
    position = np.empty(n)
    met = np.empty((sights.size, 2 + int(2.0 * s_values.max() / rest_step)))
    stood = np.empty((looks.size, met.shape[1]))
    for i in range(s_values.size):
        for j in range(j_ratios.size):
            f_s = s_values[i] * (1.0 + j_ratios[j]) / 2.0
            f_d = s_values[i] * (1.0 - j_ratios[j]) / 2.0
            count = max(2, int(2.0 * f_s / rest_step) + 1)
            n_met = 0
            for r in range(count):
                x0 = bank.op[0] + f_s * ((2.0 * r + 1.0) / count - 1.0)
                state = stem_at(x0, bank.op[0])
                bands = (f_s, f_s, f_d)
                if meets(bank.op, looks, state, bands, motion, position, stood, n_met, 0.0):
                    continue
                strokes(bank.op, looks[-1], n, state, bands, motion, position, n)
                known = False
                for other in range(n_met):
                    apart = 0.0
                    for look in range(sights.size):
                        apart += abs(met[look, other] - position[sights[look]])
                    known = known or apart <= ALIKE * f_s
                if known:
                    continue
                for look in range(sights.size):
                    met[look, n_met] = position[sights[look]]
                n_met += 1
                best, place = best_share(position, bank, delays, 1, room)
                if best > scores[i, j]:
                    scores[i, j], places[i, j], rests[i, j] = best, place, x0
    return scores, places, rests
