"""What a model leaves of PV."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopWindow
from agent.identify.fitted import start
from agent.identify.objective import DELAY, FIRST, FOPDT, J_RATIO, LEVEL, LOG_DAMPING, LOG_TAU, SIZE, S
from agent.identify.residuals import lasting, residuals
from agent.physics.valves.damped_stem import damped_stem
from tests.reference import free_run_twins as slow
from tests.reference.test_free_run_twin import ACTING, FEW, SEEDS, STRUCTURES, candidate_of, problem_of

STEM = (0.15, 0.1, 0.003)


@FEW
@given(seed=SEEDS, structure=STRUCTURES, acting=ACTING, slowness=st.sampled_from([8, 30]))
def test_their_squares_are_the_error_of_the_model(seed, structure, acting, slowness):
    problem = problem_of(seed, acting, slowness)
    fitted = start(candidate_of(seed, problem), structure, problem)
    left = residuals(fitted.candidate, fitted.structure, problem)
    # The error leaves the end of the start-up out: a tenth of it, where it has nearly faded in the first
    # block that counts.
    assert left @ left == pytest.approx(fitted.error, rel=5e-2)
    np.testing.assert_allclose(left[problem.weight == 0], 0, atol=1e-9)
    np.testing.assert_allclose(problem.basis.T @ left, 0, atol=1e-6 * np.linalg.norm(problem.pv))


def jumping_loop():
    """A noisy loop whose valve jumps, and its true candidate."""
    random = np.random.default_rng(1)
    t = np.arange(600)
    op = 50 + 4 * np.sin(t / 8) + 1.5 * np.sin(t / 37) + 0.05 * random.standard_normal(len(t))
    s, j = 4.0, 3.9
    f_s, f_d = (s + j) / 2, (s - j) / 2
    position = damped_stem(op, f_s, f_d, op[0], *STEM)
    answer = 2 * slow.first_order(position - position[0], 12.0)
    pv = 80 + np.concatenate([np.zeros(3), answer[:-3]]) + 0.02 * random.standard_normal(len(t))
    candidate = np.zeros(SIZE)
    candidate[[LOG_TAU, DELAY, S, J_RATIO, LEVEL, FIRST]] = np.log(12.0), 3.0, s, j / s, op[0] + f_s, 1.0
    candidate[LOG_DAMPING : LOG_DAMPING + 3] = np.log(STEM)
    return pose(LoopWindow("FIC1", 0.0, 1.0, op, pv)), candidate


def test_those_of_the_true_valve_are_noise_and_those_of_another_last():
    problem, candidate = jumping_loop()
    assert abs(lasting(start(candidate, FOPDT, problem), problem)) < 0.1
    candidate[S] *= 0.8
    assert lasting(start(candidate, FOPDT, problem), problem) > 0.2
