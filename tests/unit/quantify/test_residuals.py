"""What a model leaves of PV."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent.identify.fitted import start
from agent.identify.objective import FOPDT, S
from agent.identify.residuals import lasting, residuals
from tests.reference.test_free_run_twin import ACTING, FEW, SEEDS, STRUCTURES, candidate_of, problem_of
from tests.reference.test_shooting_twin import loop_whose_stem_rests_elsewhere_once


@FEW
@given(seed=SEEDS, structure=STRUCTURES, acting=ACTING, slowness=st.sampled_from([8, 30]))
def test_their_squares_are_the_error_of_the_model(seed, structure, acting, slowness):
    problem = problem_of(seed, acting, slowness)
    fitted = start(candidate_of(seed, problem), structure, problem)
    left = residuals(fitted.candidate, fitted.structure, problem)
    assert left @ left == pytest.approx(fitted.error, rel=1e-2)  # which leaves the end of the start-up out
    np.testing.assert_allclose(left[problem.weight == 0], 0, atol=1e-9)
    np.testing.assert_allclose(problem.basis.T @ left, 0, atol=1e-6 * np.linalg.norm(problem.pv))


def test_those_of_the_true_valve_are_noise_and_those_of_another_last():
    problem, candidate = loop_whose_stem_rests_elsewhere_once(0.0)
    assert abs(lasting(start(candidate, FOPDT, problem), problem)) < 0.1
    candidate[S] *= 0.8
    assert lasting(start(candidate, FOPDT, problem), problem) > 0.2
