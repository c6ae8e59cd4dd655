"""The grid of resting stems against every stem one after the other."""

import numpy as np
import pytest

from agent.analysis.innovations.valve_grid import scan_rests
from agent.identify.bank import bank
from agent.identify.first_slip import first_slip
from agent.identify.search.grid import STEMS
from agent.physics.valves.damped_stem import damped_stem
from tests.reference import free_run_twins as slow
from tests.reference.test_free_run_twin import problem_of

DELAYS = np.array([1, 3, 6])


def best_share(near, pv, f_s, f_d, count):
    """The best share over all rests, processes and delays, and the rest that gives it."""
    best = (0.0, 0.0)
    for rest in near.op[0] + f_s * (2 * (np.arange(count) + 0.5) / count - 1):
        means, moved = slow.moves(damped_stem(near.op, f_s, f_d, rest, *STEMS[0]), near.block)
        if moved < 1:
            continue
        for place in np.flatnonzero(near.gains):
            for delay in DELAYS:
                share, gain = slow.bank_share(slow.bank_response(means, delay, place, near), pv, near)
                if gain * near.gain_sign >= 0 and share > best[0]:
                    best = (share, rest)
    return best


@pytest.mark.parametrize("seed", [3, 4])
def test_the_grid_keeps_the_best_rest_of_each_cell(seed):
    problem = problem_of(seed)
    near = bank(problem, np.array([4.0, np.inf]), np.array([0.0, 0.5]), 1e9)
    s_values, j_ratios = np.array([0.1, 0.4, 1.0]) * problem.op_span, np.array([0.0, 0.6])
    step = 0.1 * problem.op_span
    scores, _, rests = scan_rests(near, STEMS[0], s_values, j_ratios, step, DELAYS)
    pv = problem.pv[: len(near.op) // near.block]
    for i, s in enumerate(s_values):
        for j, ratio in enumerate(j_ratios):
            f_s, f_d = s * (1 + ratio) / 2, s * (1 - ratio) / 2
            share, rest = best_share(near, pv, f_s, f_d, max(2, int(2 * f_s / step) + 1))
            # Stems that meet are asked once: the one kept may differ by a thousandth of f_S.
            assert scores[i, j] == pytest.approx(share, abs=2e-3)
            assert near.op[0] - f_s <= rests[i, j] <= near.op[0] + f_s or share == 0
            if scores[i, j] == pytest.approx(share, abs=1e-9) and share > 0:
                again = damped_stem(near.op, f_s, f_d, rests[i, j], *STEMS[0])
                assert again[-1] == pytest.approx(damped_stem(near.op, f_s, f_d, rest, *STEMS[0])[-1])


def test_the_first_direction_is_that_of_the_first_move():
    rng = np.random.default_rng(2)
    for _ in range(50):
        op = np.cumsum(rng.normal(size=200))
        f_s = rng.uniform(0.5, 5.0)
        rest = op[0] + f_s * rng.uniform(-0.9, 0.9)
        moves = np.diff(damped_stem(op, f_s, 0.5 * f_s, rest, *STEMS[0]), prepend=rest)
        moved = moves[moves != 0]
        assert first_slip(op, 2 * f_s, rest + f_s)[1] == (np.sign(moved[0]) if moved.size else 1.0)
