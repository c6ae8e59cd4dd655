"""Lags in series come in one order: the longest is the base's."""

import numpy as np
import pytest
from loops import made

from agent.physics.bases import Fopdt
from agent.physics.effects import EFFECTS
from agent.physics.loop_model import LoopModel
from agent.workbench.fit import refit_from
from agent.workbench.fit_order import largest_first
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record

LAG = next(each for each in EFFECTS if each.name == "second_order")


@pytest.fixture(scope="module")
def predicts():
    record = bare_record(made((LAG,), (3.0,)))
    fitted = refit_from(LoopModel(Fopdt(), (LAG,)), record, np.array([4.0, 9.0, 3.0]))
    return predictor(fitted, record)[0]


@pytest.mark.parametrize("lags", [(2.0, 9.0), (9.0, 2.0)], ids=["shorter first", "longer first"])
def test_the_longest_lag_is_the_bases_and_the_response_is_the_same(predicts, lags):
    point = predicts.space.at(np.array([4.0, *lags]))
    ordered = largest_first(predicts, point)
    np.testing.assert_allclose(predicts.space.values(ordered), [4.0, 9.0, 2.0], rtol=1e-9)
    columns = predicts.objective.columns
    np.testing.assert_allclose(columns(ordered), columns(point), atol=1e-9)


def test_a_lag_that_is_no_value_of_the_base_stays_where_it_is(predicts):
    point = predicts.space.at(np.array([4.0, 9.0, 0.0]))
    assert np.array_equal(largest_first(predicts, point), point)
    short = predicts.space.at(np.array([4.0, 0.3, 1e-6]))
    assert np.array_equal(largest_first(predicts, short), short)
